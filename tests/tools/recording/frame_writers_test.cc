// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Frames written by several threads are named in their order; a full queue says so.
#include "tools/recording/frame_writers.h"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>

#include "core/io/sequence.h"
#include "tests/tools/command_runner.h"
#include "tests/tools/live_source.h"

namespace camloc::tools {
namespace {

using std::chrono::milliseconds;

TEST(FrameWritersTest, FramesAreNamedInTheOrderInWhichTheyCame) {
  const TemporaryFolder scratch;
  RecordingFolder folder = make_folder(scratch / "walk");
  FrameWriters writers(&folder, 8, 4);
  FrameBuffer frame;
  for (int i = 1; i <= 40; ++i) {
    const int side = i % 2 == 0 ? 16 : 200;  // large and small ones overtake each other
    frame.gray.resize(side, side);
    frame.depth.pixels.clear();
    frame.depth.width = frame.depth.height = 0;
    std::fill(frame.gray.pixels.begin(), frame.gray.pixels.end(), static_cast<std::uint8_t>(i));
    ASSERT_TRUE(writers.push(&frame, i, std::nullopt, milliseconds(20000)));
  }
  EXPECT_EQ(writers.finish(), 0U);
  EXPECT_EQ(writers.totals().frames, 40U);
  EXPECT_EQ(writers.totals().frames_with_depth, 0U);
  const auto sequence = read_sequence(scratch / "walk");
  ASSERT_TRUE(sequence.is_ok()) << sequence.status().message();
  ASSERT_EQ(sequence->frames.size(), 40U);
  for (std::size_t i = 0; i < 40; ++i) EXPECT_EQ(sequence->frames[i].stamp_ns, static_cast<std::int64_t>(i) + 1);
}

TEST(FrameWritersTest, AFailedWriteStopsItAndIsTold) {
  const TemporaryFolder scratch;
  RecordingFolder folder = make_folder(scratch / "walk");
  std::filesystem::remove_all(scratch / "walk/rgb");
  FrameWriters writers(&folder, 4, 1);
  FrameBuffer frame;
  frame.gray.resize(16, 16);
  ASSERT_TRUE(writers.push(&frame, 1, std::nullopt, milliseconds(20000)));
  static_cast<void>(writers.finish());
  EXPECT_EQ(writers.totals().failure.code(), ErrorCode::kIo);
  EXPECT_EQ(writers.totals().frames, 0U);
}

}  // namespace
}  // namespace camloc::tools
