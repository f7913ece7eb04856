// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/kinect/kinect_receiver.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "tests/drivers/kinect_packet_maker.h"

namespace camloc::kinect {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

void send(KinectReceiver* receiver, Stream stream, const std::vector<Packet>& packets, std::int64_t first_ns) {
  std::int64_t time_ns = first_ns;
  for (const Packet& packet : packets) receiver->on_packet(stream, packet, time_ns += 125'000);
  receiver->on_transfer(stream, 0, time_ns);
}

TEST(KinectReceiver, FramesComeOutInOrderWithTheirTimes) {
  KinectReceiver receiver;
  PacketMaker maker(color_layout());
  EXPECT_EQ(receiver.take(Stream::kColor), nullptr);
  for (std::uint32_t i = 0; i < 2; ++i)
    send(&receiver, Stream::kColor, maker.packets_of(numbered_frame(color_layout(), i)), i * 33'000'000);
  for (std::uint32_t i = 0; i < 2; ++i) {
    RawFrame* const frame = receiver.take(Stream::kColor);
    ASSERT_NE(frame, nullptr);
    EXPECT_EQ(frame->bytes, numbered_frame(color_layout(), i));
    EXPECT_EQ(frame->device_stamp, 1'000'000 + i * PacketMaker::kFrameTicks);
    EXPECT_EQ(frame->arrival_ns, i * 33'000'000 + 125'000);
    EXPECT_EQ(frame->complete_ns, i * 33'000'000 + 162 * 125'000);
    receiver.release(Stream::kColor, frame);
  }
  EXPECT_EQ(receiver.take(Stream::kColor), nullptr);
  EXPECT_EQ(receiver.take(Stream::kDepth), nullptr);
}

TEST(KinectReceiver, NewestFramesWinAndTheReadersFrameIsLeftAlone) {
  KinectReceiver receiver;
  PacketMaker maker(depth_layout());
  std::uint32_t number = 0;
  const auto send_one = [&] { send(&receiver, Stream::kDepth, maker.packets_of(numbered_frame(depth_layout(), number++)), 1); };
  send_one();
  RawFrame* const held = receiver.take(Stream::kDepth);
  for (int i = 0; i < 10; ++i) send_one();
  EXPECT_EQ(held->bytes, numbered_frame(depth_layout(), 0));
  RawFrame* const next = receiver.take(Stream::kDepth);
  ASSERT_NE(next, nullptr);
  EXPECT_EQ(next->bytes, numbered_frame(depth_layout(), 9)) << "two wait, the rest was overwritten";
  EXPECT_EQ(receiver.report().frames_overwritten, 8U);
  receiver.release(Stream::kDepth, held);
  receiver.release(Stream::kDepth, next);
}

TEST(KinectReceiver, WaitEndsForFramesForLossAndForTheEnd) {
  KinectReceiver receiver;
  PacketMaker maker(color_layout());
  const auto soon = [] { return steady_clock::now() + milliseconds(30); };
  const auto start = steady_clock::now();
  receiver.wait_until(soon());
  EXPECT_GE(steady_clock::now() - start, milliseconds(30)) << "nothing happened";
  std::vector<Packet> packets = maker.packets_of(numbered_frame(color_layout(), 0));
  packets.erase(packets.begin() + 9);
  packets.push_back(maker.packets_of(numbered_frame(color_layout(), 1)).front());  // only now is it known that none comes late
  const auto far = steady_clock::now() + std::chrono::seconds(30);
  std::thread usb([&] { send(&receiver, Stream::kColor, packets, 1); });
  receiver.wait_until(far);
  usb.join();
  EXPECT_EQ(receiver.take(Stream::kColor), nullptr);
  EXPECT_EQ(receiver.report().counts[0].frames_incomplete, 1U);
  std::thread unplug([&] { receiver.on_gone(); });
  receiver.wait_until(far);
  unplug.join();
  EXPECT_TRUE(receiver.report().is_gone);
  EXPECT_LT(steady_clock::now(), far);
}

TEST(KinectReceiver, RestartForgetsFramesAndKeepsCounts) {
  KinectReceiver receiver;
  PacketMaker maker(color_layout());
  send(&receiver, Stream::kColor, maker.packets_of(numbered_frame(color_layout(), 0)), 1);
  std::vector<Packet> half = maker.packets_of(numbered_frame(color_layout(), 1));
  half.resize(80);
  send(&receiver, Stream::kColor, half, 1);
  receiver.restart();
  EXPECT_EQ(receiver.take(Stream::kColor), nullptr);
  PacketMaker again(color_layout(), 93, 5);
  send(&receiver, Stream::kColor, again.packets_of(numbered_frame(color_layout(), 2)), 1);
  RawFrame* const frame = receiver.take(Stream::kColor);
  ASSERT_NE(frame, nullptr);
  EXPECT_EQ(frame->bytes, numbered_frame(color_layout(), 2));
  EXPECT_EQ(receiver.report().counts[0].frames_complete, 2U);
  receiver.release(Stream::kColor, frame);
}

// Under ThreadSanitizer this is the proof that the two threads share nothing they should not.
TEST(KinectReceiver, TwoThreads) {
  KinectReceiver receiver;
  std::atomic<bool> is_done{false};
  std::thread usb([&] {
    PacketMaker color(color_layout()), depth(depth_layout());
    for (std::uint32_t i = 0; i < 30; ++i) {
      send(&receiver, Stream::kColor, color.packets_of(numbered_frame(color_layout(), i)), i);
      send(&receiver, Stream::kDepth, depth.packets_of(numbered_frame(depth_layout(), i)), i);
    }
    is_done = true;
  });
  int num_taken = 0;
  while (!is_done) {
    receiver.wait_until(steady_clock::now() + milliseconds(5));
    for (const Stream stream : {Stream::kColor, Stream::kDepth}) {
      RawFrame* const frame = receiver.take(stream);
      if (frame == nullptr) continue;
      ++num_taken;
      const StreamLayout layout = stream == Stream::kColor ? color_layout() : depth_layout();
      EXPECT_EQ(frame->bytes, numbered_frame(layout, (frame->device_stamp - 1'000'000) / PacketMaker::kFrameTicks));
      receiver.release(stream, frame);
    }
  }
  usb.join();
  EXPECT_GT(num_taken, 0);
}

TEST(FramePairing, NearestWithinHalfAPeriod) {
  constexpr std::int32_t kHalf = 1'000'000;
  const auto decide = [](std::optional<std::uint32_t> color, std::optional<std::uint32_t> depth, bool is_overdue = false) {
    return decide_pairing(color, depth, is_overdue, kHalf);
  };
  EXPECT_EQ(decide(std::nullopt, std::nullopt), Pairing::kWait);
  EXPECT_EQ(decide(std::nullopt, 5), Pairing::kWait);
  EXPECT_EQ(decide(5, std::nullopt), Pairing::kWait);
  EXPECT_EQ(decide(5, std::nullopt, true), Pairing::kColorAlone);
  EXPECT_EQ(decide(5'000'000, 5'900'000), Pairing::kPair);
  EXPECT_EQ(decide(5'000'000, 4'100'000), Pairing::kPair);
  EXPECT_EQ(decide(5'000'000, 6'100'000), Pairing::kColorAlone);
  EXPECT_EQ(decide(5'000'000, 3'900'000), Pairing::kDropDepth);
  EXPECT_EQ(decide(100'000, 0U - 300'000U), Pairing::kPair) << "over the wrap of the counter";
  EXPECT_EQ(decide(0U - 300'000U, 100'000), Pairing::kPair);
}

// Whatever the phase between the cameras, every image finds its partner.
TEST(FramePairing, TwoFreeRunningCamerasLoseNothing) {
  for (const std::uint32_t phase : {0U, 300'000U, 990'000U, 1'500'000U, 1'999'000U}) {
    std::uint32_t color = 7, depth = 7 + phase;
    int num_pairs = 0, num_alone = 0;
    for (int turn = 0; turn < 200; ++turn) {
      switch (decide_pairing(color, depth, false, 1'000'000)) {
        case Pairing::kPair: ++num_pairs, color += 2'000'000, depth += 2'000'000; break;
        case Pairing::kColorAlone: ++num_alone, color += 2'000'000; break;
        case Pairing::kDropDepth: ++num_alone, depth += 2'000'000; break;
        case Pairing::kWait: FAIL();
      }
    }
    EXPECT_LE(num_alone, 1) << phase;
    EXPECT_GE(num_pairs, 199) << phase;
  }
}

}  // namespace
}  // namespace camloc::kinect
