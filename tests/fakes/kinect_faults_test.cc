// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/fakes/kinect_faults.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "tests/fakes/kinect_frames.h"
#include "tests/fakes/kinect_rig.h"

namespace camloc::fakes {
namespace {

constexpr std::int64_t kMicroframeNs = 125'000;

struct Sent {
  std::vector<std::vector<std::uint8_t>> packets;
  std::uint64_t num_errors = 0;
  std::uint64_t num_damaged = 0;
};

/// A second of the depth stream through an injector with these faults.
Sent stream_with(const std::vector<std::string>& specs, FaultInjector* faults) {
  PatternShow show;
  KinectCamera camera({}, camera_descriptors(KinectModel::k1414, "s"), &show);
  for (const std::string& spec : specs) EXPECT_TRUE(faults->configure(spec)) << spec;
  const std::vector<std::uint8_t> start = {'G', 'M', 2, 0, 3, 0, 1, 0, 6, 0, 2, 0};
  static_cast<void>(camera.control({0x40, 0, 0, 0, 12}, start, 0));
  Sent sent;
  IsoPacket packet;
  for (std::int64_t t = 0; t < 1'000'000'000; t += kMicroframeNs) {
    bool is_error = false;
    camera.next_packet(StreamId::kDepth, t, &packet);
    if (faults->filter_packet(StreamId::kDepth, &camera, &packet, &is_error)) ++sent.num_damaged;
    if (is_error) ++sent.num_errors;
    if (packet.size > 0) sent.packets.emplace_back(packet.bytes.begin(), packet.bytes.begin() + static_cast<std::ptrdiff_t>(packet.size));
  }
  return sent;
}

/// How often a packet's sequence number is not one more than that before.
std::uint64_t num_breaks(const Sent& sent) {
  std::uint64_t count = 0;
  for (std::size_t i = 1; i < sent.packets.size(); ++i)
    if (sent.packets[i][5] != ((sent.packets[i - 1][5] + 1) & 0xff)) ++count;
  return count;
}

std::vector<std::string> sorted_packets(const Sent& sent) {
  std::vector<std::string> packets;
  for (const auto& bytes : sent.packets) packets.emplace_back(bytes.begin(), bytes.end());
  std::sort(packets.begin(), packets.end());
  return packets;
}

TEST(FaultInjector, WithoutFaultsNothingHappens) {
  FaultInjector faults(1);
  const Sent sent = stream_with({}, &faults);
  EXPECT_EQ(sent.num_damaged, 0U);
  EXPECT_EQ(num_breaks(sent), 0U);
  EXPECT_GT(sent.packets.size(), 29U * 242);
}

TEST(FaultInjector, LosesAsManyAsItCounts) {
  FaultInjector none(1), faults(1);
  const std::size_t all = stream_with({}, &none).packets.size();
  const Sent sent = stream_with({"loss=0.05"}, &faults);
  EXPECT_EQ(all - sent.packets.size(), faults.count(Fault::kLoss));
  EXPECT_NEAR(static_cast<double>(faults.count(Fault::kLoss)), 0.05 * static_cast<double>(all), 70);
  EXPECT_EQ(sent.num_damaged, faults.count(Fault::kLoss));
}

TEST(FaultInjector, DoublesAndReordersWithoutLosing) {
  FaultInjector none(1), doubles(1), swaps(1);
  const Sent plain = stream_with({}, &none);
  const Sent doubled = stream_with({"duplicate:5"}, &doubles);
  EXPECT_EQ(doubled.packets.size(), plain.packets.size() + 5);
  EXPECT_EQ(num_breaks(doubled), 5U);
  const Sent swapped = stream_with({"reorder=0.01"}, &swaps);
  ASSERT_EQ(swapped.packets.size(), plain.packets.size());
  EXPECT_GT(swaps.count(Fault::kReorder), 20U);
  EXPECT_GT(num_breaks(swapped), 2 * swaps.count(Fault::kReorder));
  EXPECT_EQ(sorted_packets(swapped), sorted_packets(plain));
}

TEST(FaultInjector, DamagesHeaders) {
  for (const auto& [spec, is_wrong] : std::initializer_list<std::pair<const char*, bool (*)(const std::vector<std::uint8_t>&)>>{
           {"bad_magic:7", [](const std::vector<std::uint8_t>& b) { return b[0] != 'R' || b[1] != 'B'; }},
           {"bad_kind:7", [](const std::vector<std::uint8_t>& b) { return b[3] != 0x71 && b[3] != 0x72 && b[3] != 0x75; }},
           {"bad_size:7", [](const std::vector<std::uint8_t>& b) { return static_cast<std::size_t>(b[6] << 8 | b[7]) != b.size(); }}}) {
    FaultInjector faults(1);
    const Sent sent = stream_with({spec}, &faults);
    EXPECT_EQ(std::count_if(sent.packets.begin(), sent.packets.end(), is_wrong), 7) << spec;
  }
}

TEST(FaultInjector, BusErrorsAreReported) {
  FaultInjector faults(1);
  EXPECT_EQ(stream_with({"bus_error:9"}, &faults).num_errors, 9U);
}

TEST(FaultInjector, SequenceJumpsOnce) {
  FaultInjector faults(1);
  EXPECT_EQ(num_breaks(stream_with({"sequence_jump:3"}, &faults)), 3U);
}

TEST(FaultInjector, SameSeedSameFaults) {
  FaultInjector a(7), b(7), c(8);
  const std::vector<std::string> specs = {"loss=0.01", "duplicate=0.01", "reorder=0.01", "short=0.01", "bad_magic=0.01"};
  const Sent first = stream_with(specs, &a);
  EXPECT_EQ(first.packets, stream_with(specs, &b).packets);
  EXPECT_NE(first.packets, stream_with(specs, &c).packets);
}

using Bytes = std::vector<std::uint8_t>;

TEST(FaultInjector, SpoilsReplies) {
  FaultInjector faults(1);
  const Bytes good = {'R', 'B', 1, 0, 3, 0, 9, 0, 0, 0};
  for (const char* const spec : {"wrong_tag:1", "wrong_magic:1", "short_reply:1"}) {
    ASSERT_TRUE(faults.configure(spec));
    std::vector<std::uint8_t> reply = good;
    EXPECT_EQ(faults.filter_reply(&reply), 0);
    EXPECT_FALSE(reply == good) << spec;
    reply = good;
    EXPECT_EQ(faults.filter_reply(&reply), 0);
    EXPECT_EQ(reply, good);
  }
  ASSERT_TRUE(faults.configure("late_reply:1"));
  std::vector<std::uint8_t> reply = good;
  EXPECT_GT(faults.filter_reply(&reply), 10'000'000);
}

TEST(FaultInjector, RefusesWhatItDoesNotKnow) {
  FaultInjector faults(1);
  for (const char* const spec : {"", "loss", "los=0.1", "loss=2", "loss=x", "loss:-1", "loss:x", "loss=nan"})
    EXPECT_FALSE(faults.configure(spec)) << spec;
}

TEST(BadDescriptors, AllDiffer) {
  const UsbDescriptors good = camera_descriptors(KinectModel::k1414, "s");
  for (const char* const name : {"no-endpoints", "truncated", "bulk-endpoints", "small-packets", "empty"}) {
    UsbDescriptors bad = good;
    const auto kind = parse_bad_descriptors(name);
    ASSERT_TRUE(kind) << name;
    spoil(*kind, &bad);
    EXPECT_NE(bad.configuration, good.configuration) << name;
  }
  EXPECT_FALSE(parse_bad_descriptors("nice"));
}

class KinectRigTest : public ::testing::Test {
 protected:
  /// Half a second of the video stream; how many packets arrive.
  int run(KinectRig* rig, std::int64_t from_ns, bool is_wanted = true) {
    int count = 0;
    IsoPacket packet;
    bool is_error = false;
    for (std::int64_t t = from_ns; t < from_ns + 500'000'000; t += kMicroframeNs) {
      rig->next_packet(StreamId::kVideo, t, is_wanted, &packet, &is_error);
      if (packet.size > 0) ++count;
    }
    return count;
  }
  void start(KinectRig* rig) {
    const std::vector<std::uint8_t> bytes = {'G', 'M', 2, 0, 3, 0, 1, 0, 5, 0, 1, 0};
    EXPECT_FALSE(rig->control(UsbDeviceId::kCamera, {0x40, 0, 0, 0, 12}, bytes, 0).is_stalled);
  }
};

TEST_F(KinectRigTest, StallsAndResumesByCommand) {
  auto rig = KinectRig::create({});
  ASSERT_TRUE(rig);
  start(rig->get());
  EXPECT_GT(run(rig->get(), 0), 14 * 162);
  EXPECT_EQ((*rig)->command("stall both forever", 500'000'000), "ok");
  EXPECT_EQ(run(rig->get(), 500'000'000), 0);
  EXPECT_EQ((*rig)->command("resume", 1'000'000'000), "ok");
  EXPECT_GT(run(rig->get(), 1'000'000'000), 14 * 162);
  const std::string counts = (*rig)->command("counts", 1'500'000'000);
  EXPECT_NE(counts.find("\"stalled\": 2"), std::string::npos) << counts;
}

TEST_F(KinectRigTest, RefusesUnknownCommands) {
  auto rig = KinectRig::create({});
  ASSERT_TRUE(rig);
  for (const char* const line : {"", "nonsense", "stall both", "stall left 3", "stall both -1", "fault", "fault x=1"})
    EXPECT_EQ((*rig)->command(line, 0).rfind("error: ", 0), 0U) << line;
  EXPECT_EQ((*rig)->command("fault loss:2", 0), "ok");
}

TEST_F(KinectRigTest, ControlStallIsRefusedOnce) {
  RigOptions options;
  options.faults = {"control_stall:1"};
  auto rig = KinectRig::create(options);
  ASSERT_TRUE(rig);
  EXPECT_TRUE((*rig)->control(UsbDeviceId::kCamera, {0xc0, 0, 0, 0, 8}, {}, 0).is_stalled);
  EXPECT_FALSE((*rig)->control(UsbDeviceId::kCamera, {0xc0, 0, 0, 0, 8}, {}, 0).is_stalled);
}

TEST_F(KinectRigTest, WhatNobodyTakesIsDamaged) {
  auto rig = KinectRig::create({});
  ASSERT_TRUE(rig);
  start(rig->get());
  run(rig->get(), 0, false);
  const std::string counts = (*rig)->command("counts", 500'000'000);
  EXPECT_NE(counts.find("\"frames\": 15, \"damaged\": 15"), std::string::npos) << counts;
}

}  // namespace
}  // namespace camloc::fakes
