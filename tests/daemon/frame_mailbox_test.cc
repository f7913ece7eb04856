// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Newest wins, drops are counted, and two threads never see each other's pixels half written.
#include "daemon/frame_mailbox.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <thread>

namespace camloc {
namespace {

void put(FrameMailbox& mailbox, std::uint64_t sequence) {
  mailbox.back().buffer.sequence = sequence;
  mailbox.publish();
}

TEST(FrameMailboxTest, EmptyGivesNothing) {
  FrameMailbox mailbox;
  EXPECT_FALSE(mailbox.has_unread());
  EXPECT_EQ(mailbox.take(), nullptr);
}

TEST(FrameMailboxTest, EachFrameIsTakenOnce) {
  FrameMailbox mailbox;
  put(mailbox, 7);
  const CapturedFrame* frame = mailbox.take();
  ASSERT_NE(frame, nullptr);
  EXPECT_EQ(frame->buffer.sequence, 7U);
  EXPECT_EQ(mailbox.take(), nullptr);
  EXPECT_EQ(mailbox.num_dropped(), 0U);
}

TEST(FrameMailboxTest, NewestWinsAndDropsAreCounted) {
  FrameMailbox mailbox;
  for (std::uint64_t i = 1; i <= 5; ++i) put(mailbox, i);
  EXPECT_EQ(mailbox.take()->buffer.sequence, 5U);
  EXPECT_EQ(mailbox.num_dropped(), 4U);
}

TEST(FrameMailboxTest, TakenFrameIsLeftAlone) {
  FrameMailbox mailbox;
  put(mailbox, 1);
  const CapturedFrame* taken = mailbox.take();
  for (std::uint64_t i = 2; i <= 9; ++i) {
    EXPECT_NE(&mailbox.back(), taken);
    put(mailbox, i);
  }
  EXPECT_EQ(taken->buffer.sequence, 1U);
}

TEST(FrameMailboxTest, ThreadsSeeWholeFramesInOrder) {
  constexpr std::uint64_t kFrames = 20000;
  constexpr int kSide = 16;
  FrameMailbox mailbox;
  std::thread writer([&] {
    for (std::uint64_t i = 1; i <= kFrames; ++i) {
      CapturedFrame& frame = mailbox.back();
      frame.buffer.sequence = i;
      frame.buffer.gray.resize(kSide, kSide);
      std::fill(frame.buffer.gray.pixels.begin(), frame.buffer.gray.pixels.end(), static_cast<std::uint8_t>(i));
      mailbox.publish();
    }
  });
  std::uint64_t last = 0, num_taken = 0, num_torn = 0, num_backwards = 0;
  while (last < kFrames) {
    const CapturedFrame* frame = mailbox.take();
    if (frame == nullptr) {
      std::this_thread::yield();
      continue;
    }
    ++num_taken;
    num_backwards += frame->buffer.sequence <= last ? 1 : 0;
    last = frame->buffer.sequence;
    const auto& pixels = frame->buffer.gray.pixels;
    num_torn += std::any_of(pixels.begin(), pixels.end(), [&](std::uint8_t p) { return p != static_cast<std::uint8_t>(last); }) ? 1 : 0;
  }
  writer.join();
  EXPECT_EQ(num_torn, 0U);
  EXPECT_EQ(num_backwards, 0U);
  EXPECT_EQ(num_taken + mailbox.num_dropped(), kFrames);
}

}  // namespace
}  // namespace camloc
