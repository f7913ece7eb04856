// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Up from a shaken accelerometer and from a floor with tables on it; refusals where there is nothing to tell from.
#include "core/geometry/gravity.h"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/geometry/generated.h"

namespace camloc {
namespace {

using testing::random_vector;

constexpr double kDegree = std::numbers::pi / 180;

double angle(const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

/// A camera that looks around: turns about up, pitch and roll of some 15 degrees.
Eigen::Quaterniond look(std::mt19937& rng, const Eigen::Quaterniond& R_map_level, double tilt_sigma_rad) {
  std::uniform_real_distribution<double> uniform(-std::numbers::pi, std::numbers::pi);
  // Level frame: z up. A camera with y down, z forward.
  Eigen::Matrix3d R_level_camera;
  R_level_camera << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  const Eigen::Quaterniond turned = exp_so3({0, 0, uniform(rng)}) * Eigen::Quaterniond(R_level_camera);
  return (R_map_level * turned * exp_so3(random_vector(rng, tilt_sigma_rad))).normalized();
}

struct Carried {
  Eigen::Vector3d up_map;
  std::vector<OrientedReading> readings;
};

Carried carry(int count, double noise_mps2, double outlier_share, const Eigen::Matrix3d& R_camera_accelerometer,
              double tilt_sigma_rad = 0.26) {
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> uniform(0, 1);
  const Eigen::Quaterniond R_map_level = exp_so3({0.3, -0.2, 0.9});
  Carried carried{R_map_level * Eigen::Vector3d::UnitZ(), {}};
  for (int i = 0; i < count; ++i) {
    OrientedReading reading;
    reading.R_map_camera = look(rng, R_map_level, tilt_sigma_rad);
    Eigen::Vector3d force = kStandardGravity * (reading.R_map_camera.conjugate() * carried.up_map) + random_vector(rng, noise_mps2);
    if (uniform(rng) < outlier_share) force += random_vector(rng, 6);
    reading.acceleration = R_camera_accelerometer.transpose() * force;
    carried.readings.push_back(reading);
  }
  return carried;
}

TEST(GravityFromAccelerometer, FindsUpThroughNoiseAndPushes) {
  const Carried carried = carry(600, 0.3, 0.3, kinect_R_camera_accelerometer());
  const auto estimate = gravity_from_accelerometer(carried.readings);
  ASSERT_TRUE(estimate.is_ok()) << estimate.status().message();
  EXPECT_LT(angle(estimate->up_map, carried.up_map), 0.3 * kDegree);
  EXPECT_NEAR(estimate->up_map.norm(), 1, 1e-12);
  EXPECT_EQ(estimate->source, GravitySource::kAccelerometer);
  EXPECT_GT(estimate->sigma_rad, angle(estimate->up_map, carried.up_map));
  EXPECT_LT(estimate->sigma_rad, 1.5 * kDegree);
  EXPECT_GT(estimate->inlier_share, 0.7);
}

TEST(GravityFromAccelerometer, RefusesFewReadingsPushesAndWrongAxes) {
  const Carried few = carry(10, 0.1, 0, kinect_R_camera_accelerometer());
  EXPECT_EQ(gravity_from_accelerometer(few.readings).status().code(), ErrorCode::kInvalid);
  EXPECT_FALSE(gravity_from_accelerometer({}).is_ok());
  Carried pushed = carry(100, 0.1, 0, kinect_R_camera_accelerometer());
  for (OrientedReading& reading : pushed.readings) reading.acceleration *= 2;
  EXPECT_NE(gravity_from_accelerometer(pushed.readings).status().message().find("0 of 100"), std::string::npos);
  Carried invalid = carry(100, 0.1, 0, kinect_R_camera_accelerometer());
  for (OrientedReading& reading : invalid.readings) reading.acceleration.x() = std::nan("");
  EXPECT_FALSE(gravity_from_accelerometer(invalid.readings).is_ok());
  // z and y exchanged.
  Eigen::Matrix3d exchanged = Eigen::Matrix3d::Zero();
  exchanged(0, 0) = exchanged(1, 2) = exchanged(2, 1) = 1;
  const auto wrong = gravity_from_accelerometer(carry(300, 0.1, 0, exchanged).readings);
  ASSERT_FALSE(wrong.is_ok());
  EXPECT_NE(wrong.status().message().find("axes"), std::string::npos) << wrong.status().message();
}

TEST(RoughUp, MeanOfTheImageTops) {
  std::mt19937 rng(3);
  const Eigen::Quaterniond R_map_level = exp_so3({0.3, -0.2, 0.9});
  std::vector<Rigid3> poses;
  for (int i = 0; i < 50; ++i) poses.push_back({look(rng, R_map_level, 0.3), random_vector(rng, 3)});
  ASSERT_TRUE(rough_up(poses).has_value());
  EXPECT_LT(angle(*rough_up(poses), R_map_level * Eigen::Vector3d::UnitZ()), 8 * kDegree);
  EXPECT_FALSE(rough_up({}).has_value());
  poses.clear();
  for (int i = 0; i < 200; ++i) poses.push_back(testing::random_pose(rng, 1));
  EXPECT_FALSE(rough_up(poses).has_value());
}

/// Points of a room of 8 x 6 m, axes z up, before it is turned into `map`.
struct Room {
  std::vector<Eigen::Vector3d> points, cameras;
  std::mt19937 rng{5};

  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(rng); }
  void add_level(int count, double x0, double x1, double y0, double y1, double z, double noise_m = 0.006) {
    for (int i = 0; i < count; ++i) points.push_back({uniform(x0, x1), uniform(y0, y1), z + random_vector(rng, noise_m).z()});
  }
  void add_walls(int count) {
    for (int i = 0; i < count; ++i) {
      const double along = uniform(0, 28), z = uniform(0, 2.6);
      if (along < 8)
        points.push_back({along, 0, z});
      else if (along < 16)
        points.push_back({along - 8, 6, z});
      else if (along < 22)
        points.push_back({0, along - 16, z});
      else
        points.push_back({8, along - 22, z});
    }
  }
  void add_clutter(int count) {
    for (int i = 0; i < count; ++i) points.push_back({uniform(0, 8), uniform(0, 6), uniform(0, 1.5)});
  }
  void add_cameras() {
    for (int i = 0; i < 40; ++i) cameras.push_back({uniform(1, 7), uniform(1, 5), 1.6 + uniform(-0.1, 0.1)});
  }
  void turn(const Rigid3& T_map_room) {
    for (Eigen::Vector3d& p : points) p = T_map_room * p;
    for (Eigen::Vector3d& p : cameras) p = T_map_room * p;
  }
};

const Rigid3 kTurn{exp_so3({0.3, -0.2, 0.9}), {5, -7, 2}};

/// 25 degrees off.
Eigen::Vector3d wrong_up() { return kTurn.rotation * (exp_so3({25 * kDegree, 0, 0}) * Eigen::Vector3d::UnitZ()); }

TEST(GravityFromFloor, FindsTheFloorUnderTablesAndClutter) {
  Room room;
  room.add_level(6000, 0, 8, 0, 6, 0);
  room.add_level(4000, 2, 5, 2, 4, 0.74);  // a large table
  room.add_walls(8000);
  room.add_clutter(3000);
  room.add_cameras();
  room.turn(kTurn);
  const auto estimate = gravity_from_floor(room.points, room.cameras, wrong_up());
  ASSERT_TRUE(estimate.is_ok()) << estimate.status().message();
  const Eigen::Vector3d truth = kTurn.rotation * Eigen::Vector3d::UnitZ();
  EXPECT_LT(angle(estimate->up_map, truth), 0.15 * kDegree);
  EXPECT_LT(angle(estimate->up_map, truth), 3 * estimate->sigma_rad);
  EXPECT_NEAR(estimate->camera_height_m, 1.6, 0.05);
  EXPECT_EQ(estimate->source, GravitySource::kFloor);
  EXPECT_GT(estimate->inlier_share, 0.25);
}

// The table holds more points than what is seen of the floor.
TEST(GravityFromFloor, ATableIsNoFloor) {
  Room room;
  room.add_level(6000, 2, 6, 2, 5, 0.74);
  room.add_level(3000, 0, 8, 0, 2, 0);
  room.add_cameras();
  room.turn(kTurn);
  const auto estimate = gravity_from_floor(room.points, room.cameras, wrong_up());
  ASSERT_TRUE(estimate.is_ok()) << estimate.status().message();
  EXPECT_NEAR(estimate->camera_height_m, 1.6, 0.05);
}

TEST(GravityFromFloor, SameBitsForSamePoints) {
  Room room;
  room.add_level(100000, 0, 8, 0, 6, 0);
  room.add_clutter(100000);
  room.add_cameras();
  const auto a = gravity_from_floor(room.points, room.cameras, {0, 0.2, 1}), b = gravity_from_floor(room.points, room.cameras, {0, 0.2, 1});
  ASSERT_TRUE(a.is_ok());
  EXPECT_EQ(a->up_map, b->up_map);
}

TEST(GravityFromFloor, RefusesWhereThereIsNone) {
  const auto expect_none = [](const Room& room, const char* reason) {
    const auto estimate = gravity_from_floor(room.points, room.cameras, {0, 0, 1});
    ASSERT_FALSE(estimate.is_ok()) << reason << ": found one " << estimate->camera_height_m << " below, share " << estimate->inlier_share;
    EXPECT_NE(estimate.status().message().find(reason), std::string::npos) << estimate.status().message();
  };
  Room empty;
  EXPECT_EQ(gravity_from_floor(empty.points, empty.cameras, {0, 0, 1}).status().code(), ErrorCode::kInvalid);
  empty.add_cameras();
  expect_none(empty, "no points below");
  Room ceiling;
  ceiling.add_level(5000, 0, 8, 0, 6, 2.6);
  ceiling.add_cameras();
  expect_none(ceiling, "no points below");
  Room clutter;
  clutter.add_clutter(20000);
  clutter.add_cameras();
  expect_none(clutter, "holds only");
  Room patch;
  patch.add_level(2000, 2, 2.4, 2, 2.4, 0);
  patch.add_clutter(3000);
  patch.add_cameras();
  expect_none(patch, "small patch");
  Room ramp;  // 45 degrees
  ramp.add_level(5000, 0, 8, 0, 6, 0);
  for (Eigen::Vector3d& p : ramp.points) p = exp_so3({0, 45 * kDegree, 0}) * p;
  ramp.cameras = {{2, 3, 1.6}, {3, 3, 1.6}};
  EXPECT_FALSE(gravity_from_floor(ramp.points, ramp.cameras, {0, 0, 1}).is_ok());
  Room invalid;
  invalid.points.assign(1000, Eigen::Vector3d(std::nan(""), 0, 0));
  invalid.add_cameras();
  expect_none(invalid, "no points below");
}

}  // namespace
}  // namespace camloc
