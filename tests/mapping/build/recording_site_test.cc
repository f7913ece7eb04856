// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Which way is up in a walk, and what the survey of a build takes.
#include "tools/mapping/build/recording_site.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/drivers/test_folder.h"
#include "tests/mapping/recorded_room.h"

namespace camloc::mapping {
namespace {

/// A camera that goes straight on at 1.5 m above the plane up . p = 0 and looks down a little.
SlamResult walk(const Eigen::Vector3d& up) {
  SlamResult result;
  result.segments.push_back({7, 40, 40, {}, {}});
  const Eigen::Quaterniond R_map_world = shortest_turn(Eigen::Vector3d::UnitZ(), up.normalized());
  for (std::uint64_t i = 0; i < 40; ++i) {
    Eigen::Matrix3d R;  // x right, y down, z forward, in a world with z up
    const double yaw = 0.1 * static_cast<double>(i);
    const Eigen::Vector3d forward(std::cos(yaw), std::sin(yaw), -0.3), z = forward.normalized(),
                                                                       x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
    R << x, z.cross(x), z;
    const Rigid3 T_world_camera{Eigen::Quaterniond(R), {0.1 * static_cast<double>(i), 0, 1.5}};
    result.poses.push_back({i, static_cast<std::int64_t>(i) * 100'000'000, 7, Rigid3{R_map_world, {0, 0, 0}} * T_world_camera, 50, true});
  }
  return result;
}

/// Points of the floor, as each keyframe sees them.
std::vector<KeyframeSurface> floor_seen(const SlamResult& result, const Eigen::Vector3d& up) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(-3, 3);
  const Eigen::Quaterniond R_map_world = shortest_turn(Eigen::Vector3d::UnitZ(), up.normalized());
  std::vector<KeyframeSurface> surfaces;
  for (const SlamPose& pose : result.poses) {
    KeyframeSurface& surface = surfaces.emplace_back(KeyframeSurface{pose.frame, {}});
    for (int i = 0; i < 60; ++i)
      surface.points_m.push_back(
          (pose.T_map_camera.inverse() * (R_map_world * Eigen::Vector3d(2 + unit(random), unit(random), 0))).cast<float>());
  }
  return surfaces;
}

TEST(RecordingSite, UpIsAcrossTheFloorAndTurnsTheWalkUpright) {
  const Eigen::Vector3d up = Eigen::Vector3d(0.2, -0.1, 1).normalized();
  SlamResult result = walk(up);
  const TestFolder folder;
  const auto found = find_up(result, floor_seen(result, up), folder.path(), "");
  ASSERT_TRUE(found.is_ok()) << found.status().message();
  EXPECT_EQ(found->source, GravitySource::kFloor);
  EXPECT_LT((found->up_map - up).norm(), 1e-3);
  EXPECT_NEAR(found->camera_height_m, 1.5, 0.01);
  result.poses[3].segment = 8;  // of another map
  const Rigid3 other = result.poses[3].T_map_camera;
  level(found->up_map, 7, &result);
  EXPECT_NEAR(result.poses[39].T_map_camera.translation.z(), 1.5, 0.02);
  EXPECT_EQ(result.poses[3].T_map_camera.translation, other.translation);
}

TEST(RecordingSite, WithoutFloorAndAccelerometerUpIsNotKnown) {
  const SlamResult result = walk(Eigen::Vector3d::UnitZ());
  const TestFolder folder;
  EXPECT_EQ(find_up(result, {}, folder.path(), "").status().code(), ErrorCode::kNotFound);
  EXPECT_FALSE(find_up(result, {}, folder.path(), folder / "none.txt").is_ok());
  // A file beside the recording is taken where there is no floor; one that is broken is an error.
  const std::string beside = folder.write("accelerometer.txt", "not a number\n");
  const auto broken = find_up(result, {}, folder.path(), "");
  ASSERT_FALSE(broken.is_ok());
  EXPECT_NE(broken.status().message().find(beside), std::string::npos) << broken.status().message();
  EXPECT_TRUE(find_up(result, floor_seen(result, Eigen::Vector3d::UnitZ()), folder.path(), "").is_ok());
}

TEST(RecordingSite, ASurveyHasPixelsOfFramesOnly) {
  const TestFolder folder;
  record_room(folder / "walk", 6);
  SurveyRequest request;
  request.points_path = folder.write("points.csv", "A 1 2 3\nB 4 5 6\n");
  request.observed_path = folder.write("seen.txt", "A pixel 4 160 120\nB pixel 1 100 100\nA pixel 1 200 100\nB pixel 77 10 10\n");
  const auto survey = read_survey(request, folder / "walk", room_camera());
  ASSERT_TRUE(survey.is_ok()) << survey.status().message();
  EXPECT_EQ(survey->points.size(), 2U);
  EXPECT_EQ(frames_of(*survey), (std::vector<std::uint64_t>{1, 4, 77}));
  ASSERT_EQ(survey->measurements.size(), 4U);
  EXPECT_TRUE(survey->measurements.at(1).is_ok());
  EXPECT_GT(survey->measurements.at(1)->depth_m, 0.5);
  EXPECT_FALSE(survey->measurements.at(4).is_ok()) << "the recording has no frame 77";
  request.observed_path = folder.write("picked.txt", "A map 1 2 3\n");
  const auto refused = read_survey(request, folder / "walk", room_camera());
  ASSERT_FALSE(refused.is_ok());
  EXPECT_NE(refused.status().message().find("picked.txt:1"), std::string::npos) << refused.status().message();
}

}  // namespace
}  // namespace camloc::mapping
