// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Real recordings, where they are at hand (environment variable CAMLOC_DATA).
#include <algorithm>
#include <chrono>

#include "core/io/sequence.h"
#include "drivers/sources.h"
#include "tests/drivers/test_folder.h"

namespace camloc {
namespace {

struct Expected {
  const char* folder;
  const char* layout;
  std::size_t num_frames;
  std::size_t least_with_depth;
  std::size_t least_with_pose;
};

void PrintTo(const Expected& expected, std::ostream* out) { *out << expected.folder; }

class RecordedSequences : public ::testing::TestWithParam<Expected> {};

TEST_P(RecordedSequences, IndexPosesAndFirstFrames) {
  const Expected expected = GetParam();
  const std::string folder = data_folder(expected.folder);
  if (!std::filesystem::is_directory(folder)) GTEST_SKIP() << "no recording " << folder;
  const auto sequence = read_sequence(folder);
  ASSERT_TRUE(sequence.is_ok()) << sequence.status().message();
  EXPECT_EQ(sequence->layout, expected.layout);
  EXPECT_EQ(sequence->frames.size(), expected.num_frames);
  const auto has_depth = [](const SequenceFrame& frame) { return !frame.depth_path.empty(); };
  EXPECT_GE(static_cast<std::size_t>(std::count_if(sequence->frames.begin(), sequence->frames.end(), has_depth)),
            expected.least_with_depth);
  const auto poses = read_embedded_poses(*sequence);
  ASSERT_EQ(poses.is_ok(), expected.least_with_pose > 0) << poses.status().message();
  if (poses) {
    EXPECT_EQ(poses->size(), expected.num_frames);
    const auto count = std::count_if(poses->begin(), poses->end(), [](const auto& pose) { return pose.has_value(); });
    EXPECT_GE(static_cast<std::size_t>(count), expected.least_with_pose);
  }
  auto source = open_frame_source(folder + "?frames=0:3");
  ASSERT_TRUE(source.is_ok()) << source.status().message();
  FrameBuffer frame;
  for (int i = 0; i < 3; ++i) {
    const Status status = (*source)->next(&frame, std::chrono::milliseconds(0));
    ASSERT_TRUE(status.is_ok()) << status.message();
    EXPECT_EQ(frame.gray.width, 640);
    EXPECT_EQ(frame.gray.height, 480);
  }
}

INSTANTIATE_TEST_SUITE_P(All, RecordedSequences,
                         ::testing::Values(Expected{"kitchen", "7scenes", 600, 600, 600}, Expected{"tum_fr1_rpy", "tum", 362, 350, 350},
                                           Expected{"tum_fr1_xyz", "tum", 10, 10, 10}, Expected{"elsewhere", "7scenes", 13, 13, 0}),
                         [](const auto& one) { return std::string(one.param.folder); });

}  // namespace
}  // namespace camloc
