// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Poses that a recording brings along, as those of its colour camera.
#include <gtest/gtest.h>

#include "tests/drivers/test_folder.h"
#include "tools/evaluation/trajectory_error.h"

namespace camloc::tools {
namespace {

/// 7-Scenes: frame i of the depth camera at x = i / 10; frame 2 has no pose.
void write_recording(const TestFolder& folder, int count) {
  write_7scenes(folder, count);
  for (int i = 0; i < count; ++i) {
    char name[40];
    std::snprintf(name, sizeof name, "frame-%06d.pose.txt", i);
    if (i != 2) folder.write(name, "1 0 0 " + std::to_string(0.1 * i) + "\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  }
}

TEST(PosesOfARecordingTest, SelectedFramesWithAPose) {
  const TestFolder folder;
  write_recording(folder, 6);
  const auto all = read_recorded_poses(folder.path(), "", std::nullopt);
  ASSERT_TRUE(all.is_ok()) << all.status().message();
  EXPECT_EQ(all->num_frames, 6U);
  ASSERT_EQ(all->poses.size(), 5U);
  EXPECT_NEAR(all->poses[2].T_world_camera.translation.x(), 0.3, 1e-9);
  const auto some = read_recorded_poses(folder.path(), "1:4", std::nullopt);
  ASSERT_TRUE(some.is_ok());
  EXPECT_EQ(some->num_frames, 3U);
  EXPECT_EQ(some->poses.size(), 2U);
  EXPECT_EQ(some->poses[1].stamp_ns, all->poses[2].stamp_ns);
}

TEST(PosesOfARecordingTest, ThoseOfTheDepthCameraAreMovedToTheColourCamera) {
  const TestFolder folder;
  write_recording(folder, 2);
  const Rigid3 T_color_depth{Eigen::Quaterniond(Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitY())), {0.025, 0, 0}};
  const auto poses = read_recorded_poses(folder.path(), "", T_color_depth);
  ASSERT_TRUE(poses.is_ok());
  const Rigid3 expected = Rigid3{Eigen::Quaterniond::Identity(), {0.1, 0, 0}} * T_color_depth.inverse();
  EXPECT_LT((poses->poses[1].T_world_camera.translation - expected.translation).norm(), 1e-9);
  EXPECT_LT(rotation_distance_rad(poses->poses[1].T_world_camera.rotation, expected.rotation), 1e-9);
}

TEST(PosesOfARecordingTest, ErrorsAreThoseOfTheRecordingAndTheSelection) {
  const TestFolder folder;
  write_recording(folder, 2);
  EXPECT_FALSE(read_recorded_poses("/nowhere", "", std::nullopt).is_ok());
  EXPECT_FALSE(read_recorded_poses(folder.path(), "a:b", std::nullopt).is_ok());
}

}  // namespace
}  // namespace camloc::tools
