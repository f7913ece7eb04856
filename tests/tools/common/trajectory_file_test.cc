// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Trajectories survive being written and read; damaged ones are named with their line.
#include "tools/common/trajectory_file.h"

#include "core/io/file_bytes.h"
#include "tests/tools/command_runner.h"

namespace camloc::tools {
namespace {

EstimatedTrajectory example() {
  EstimatedTrajectory trajectory;
  trajectory.num_frames = 7;
  trajectory.T_color_depth = Rigid3{Eigen::Quaterniond(0.6, 0.8, 0, 0), {-0.025, 0.1, 3}};
  trajectory.suspect_focal_scale = 1.125;
  for (int i = 0; i < 3; ++i) {
    EstimatedPose pose;
    pose.stamp_ns = 1'300'000'000'123'456'789 + i * 33'000'000LL;
    pose.T_map_camera = {Eigen::Quaterniond(0.5, -0.5, 0.5, 0.5), {i * 1.0, 2.5, -1e-3}};
    if (i != 1) {
      Matrix6d A = Matrix6d::Identity();
      A(0, 5) = 0.25 * i;
      pose.covariance = 1e-4 * A * A.transpose();
    }
    trajectory.poses.push_back(pose);
  }
  return trajectory;
}

TEST(TrajectoryFileTest, WhatIsWrittenIsRead) {
  const TemporaryFolder folder;
  const EstimatedTrajectory written = example();
  ASSERT_TRUE(replace_file(folder / "t.tum", format_trajectory(written)).is_ok());
  const auto read = read_trajectory(folder / "t.tum");
  ASSERT_TRUE(read.is_ok()) << read.status().message();
  EXPECT_EQ(read->num_frames, written.num_frames);
  EXPECT_DOUBLE_EQ(*read->suspect_focal_scale, 1.125);
  EXPECT_TRUE(read->T_color_depth->translation.isApprox(written.T_color_depth->translation, 1e-8));
  ASSERT_EQ(read->poses.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(read->poses[i].stamp_ns, written.poses[i].stamp_ns);
    EXPECT_NEAR((read->poses[i].T_map_camera.translation - written.poses[i].T_map_camera.translation).norm(), 0, 1e-6);
    EXPECT_NEAR(rotation_distance_rad(read->poses[i].T_map_camera.rotation, written.poses[i].T_map_camera.rotation), 0, 1e-6);
    ASSERT_EQ(read->poses[i].covariance.has_value(), i != 1);
    if (i == 1) continue;
    EXPECT_TRUE(read->poses[i].covariance->isApprox(*written.poses[i].covariance, 1e-6));
  }
}

TEST(TrajectoryFileTest, ReadsPlainTumFiles) {
  const TemporaryFolder folder;
  const auto read =
      read_trajectory(folder.write("t.tum", "# by another program\n# frame 3 of 7\n1.5 0 0 1 0 0 0 1\n\n2.5 0 0 2 0 0 0 1\n"));
  ASSERT_TRUE(read.is_ok()) << read.status().message();
  EXPECT_EQ(read->poses.size(), 2U);
  EXPECT_FALSE(read->num_frames || read->T_color_depth || read->suspect_focal_scale || read->poses[0].covariance);
}

TEST(TrajectoryFileTest, ErrorsNameFileAndLine) {
  const TemporaryFolder folder;
  const std::pair<const char*, const char*> cases[] = {{"1 0 0\n", ":1"},
                                                       {"1 0 0 0 0 0 0 1\n# covariance 1 2 3\n", ":2"},
                                                       {"# frames many\n", ":1"},
                                                       {"# reference_camera depth 1 2 3 0 0 0 0\n", ":1"},
                                                       {"# calibration suspect\n", ":1"},
                                                       {"1 nan 0 0 0 0 0 1\n", ":1"}};
  for (const auto& [text, where] : cases) {
    const auto read = read_trajectory(folder.write("bad.tum", text));
    ASSERT_FALSE(read.is_ok()) << text;
    EXPECT_NE(read.status().message().find("bad.tum" + std::string(where)), std::string::npos) << read.status().message();
  }
  EXPECT_EQ(read_trajectory(folder / "none.tum").status().code(), ErrorCode::kNotFound);
}

TEST(TrajectoryFileTest, AFailedWriteLeavesNothing) {
  const TemporaryFolder folder;
  EXPECT_EQ(replace_file(folder / "no/t.tum", "x").code(), ErrorCode::kIo);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace camloc::tools
