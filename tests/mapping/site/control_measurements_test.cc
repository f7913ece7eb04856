// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Measurements of control points as points of the map, with what they are good for.
#include <gtest/gtest.h>

#include <random>

#include "tests/geometry/generated.h"
#include "tools/mapping/site/control_points.h"

namespace camloc::mapping {
namespace {

RgbdCamera measurement_camera() {
  RgbdCamera camera;
  camera.color = camera.depth = {640, 480, 525, 525, 319.5, 239.5, LensModel::kPinhole, {}};
  return camera;
}

TEST(PixelMeasurement, DepthAndRayOfAFlatWall) {
  const RgbdCamera camera = measurement_camera();
  Image<std::uint16_t> depth;
  depth.resize(640, 480);
  std::fill(depth.pixels.begin(), depth.pixels.end(), std::uint16_t{2000});
  const DepthLookup lookup(camera);
  const ControlObservation pixel{"A", ObservationKind::kPixel, {}, 0, 3, 424.5, 239.5, 1.5, 1};
  const auto measured = measure_pixel(pixel, camera, lookup, depth.view());
  ASSERT_TRUE(measured.is_ok()) << measured.status().message();
  EXPECT_NEAR(measured->depth_m, 2, 1e-6);
  EXPECT_NEAR(measured->normalized.x(), 0.2, 1e-9);
  EXPECT_EQ(measured->sigma_px, 1.5);

  ControlObservation outside = pixel;
  outside.u = 640;
  EXPECT_EQ(measure_pixel(outside, camera, lookup, depth.view()).status().code(), ErrorCode::kInvalid);
  EXPECT_EQ(measure_pixel(pixel, camera, lookup, {}).status().code(), ErrorCode::kNotFound);
  std::fill(depth.pixels.begin(), depth.pixels.end(), std::uint16_t{0});
  EXPECT_EQ(measure_pixel(pixel, camera, lookup, depth.view()).status().code(), ErrorCode::kNotFound);
  depth.resize(320, 240);
  EXPECT_EQ(measure_pixel(pixel, camera, lookup, depth.view()).status().code(), ErrorCode::kInvalid);
}

TEST(PixelMeasurement, OnlyOfTheFrameAtHand) {
  const auto observations =
      parse_control_observations("A pixel 3 100 100\nA pixel 4 100 100\nB map 1 2 3\nC pixel 3 700 100\n", "seen.txt");
  ASSERT_TRUE(observations.is_ok());
  const RgbdCamera camera = measurement_camera();
  FrameBuffer frame;
  frame.sequence = 3;
  frame.depth.resize(640, 480);
  std::fill(frame.depth.pixels.begin(), frame.depth.pixels.end(), std::uint16_t{1500});
  PixelMeasurements measurements;
  measure_pixels(*observations, camera, DepthLookup(camera), frame.view(), &measurements);
  ASSERT_EQ(measurements.size(), 2U);
  EXPECT_NEAR(measurements.at(1)->depth_m, 1.5, 1e-6);
  EXPECT_FALSE(measurements.at(4).is_ok());
}

// Against a Monte Carlo of pixel, depth and pose.
TEST(PixelMeasurement, SigmaOfThePointIsHonest) {
  std::mt19937 rng(4);
  std::normal_distribution<double> normal;
  const RgbdCamera camera = measurement_camera();
  const Rigid3 T_map_camera = testing::random_pose(rng, 2);
  const ControlObservation pixel{"A", ObservationKind::kPixel, {}, 0, 3, 500, 100, 1.5, 1};
  const Eigen::Vector2d normalized = camera.color.undistort({500, 100});
  Matrix6d covariance = Matrix6d::Zero();
  covariance.diagonal() << 1e-4, 4e-4, 1e-4, 1e-5, 2e-5, 1e-5;
  const PointMeasurement truth = to_map(pixel, {normalized, 3.0, 1.5}, camera, {T_map_camera, covariance});
  double sum_squared = 0;
  constexpr int kTrials = 20000;
  for (int i = 0; i < kTrials; ++i) {
    Rigid3 T = T_map_camera;
    const Eigen::Vector3d turn(std::sqrt(1e-5) * normal(rng), std::sqrt(2e-5) * normal(rng), std::sqrt(1e-5) * normal(rng));
    T.rotation = exp_so3(turn) * T.rotation;
    T.translation += Eigen::Vector3d(0.01 * normal(rng), 0.02 * normal(rng), 0.01 * normal(rng));
    const Eigen::Vector2d n = camera.color.undistort({500 + 1.5 * normal(rng), 100 + 1.5 * normal(rng)});
    const double z = 3 + camera.depth_noise.sigma_m(3) * normal(rng);
    sum_squared += (T * Eigen::Vector3d(z * n.x(), z * n.y(), z) - truth.p_map).squaredNorm() / 3;
  }
  EXPECT_NEAR(std::sqrt(sum_squared / kTrials) / truth.sigma_m, 1, 0.05);
}

TEST(ResolveObservations, TakesWhatTheSourcesGiveAndNamesTheRest) {
  const auto observations = parse_control_observations(
      "A map 1 2 3\nB landmark 5\nB landmark 6\nC pixel 10 100 100\nC pixel 11 100 100\nD pixel 12 100 100\n", "seen.txt");
  ASSERT_TRUE(observations.is_ok());
  ControlSources sources;
  sources.landmark = [](std::uint32_t landmark) -> Result<PointMeasurement> {
    if (landmark != 5) return {ErrorCode::kNotFound, "no such landmark"};
    return PointMeasurement{{}, {5, 5, 5}, 0.01, {}};
  };
  sources.T_map_camera = [](std::uint64_t frame) -> Result<PoseWithCovariance> {
    if (frame == 11) return {ErrorCode::kNotFound, "lost"};
    return PoseWithCovariance{{Eigen::Quaterniond::Identity(), {0, 0, 1}}, Matrix6d::Zero()};
  };
  sources.pixel = [](const ControlObservation& pixel) -> Result<PixelMeasurement> {
    if (pixel.frame == 12) return {ErrorCode::kNotFound, "no depth"};
    return PixelMeasurement{{0.5, 0.25}, 2, pixel.sigma};
  };
  const ResolvedObservations resolved = resolve_observations(*observations, measurement_camera(), sources);
  ASSERT_EQ(resolved.measurements.size(), 3U);
  EXPECT_EQ(resolved.measurements[1].name, "B");
  EXPECT_EQ(resolved.measurements[1].p_map, Eigen::Vector3d(5, 5, 5));
  EXPECT_EQ(resolved.measurements[2].name, "C");
  EXPECT_LT((resolved.measurements[2].p_map - Eigen::Vector3d(1, 0.5, 3)).norm(), 1e-12);
  const std::vector<std::string> left_out = {"B, landmark 6: no such landmark", "C, pixel (100.0, 100.0) of frame 11: lost",
                                             "D, pixel (100.0, 100.0) of frame 12: no depth"};
  EXPECT_EQ(resolved.left_out, left_out);
  // Without any source only positions are left.
  EXPECT_EQ(resolve_observations(*observations, measurement_camera(), {}).measurements.size(), 1U);
  EXPECT_EQ(resolve_observations(*observations, measurement_camera(), {}).left_out.size(), 5U);
}

TEST(AverageMeasurements, WeighsAndShowsTheScatter) {
  const std::vector<PointMeasurement> measurements = {
      {"A", {1, 0, 0}, 0.01, "first"}, {"B", {9, 9, 9}, 0.02, "alone"}, {"A", {1.02, 0, 0}, 0.02, "second"}};
  const std::vector<ObservedPoint> points = average_measurements(measurements);
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points[0].name, "A");
  EXPECT_NEAR(points[0].p_map.x(), 1.004, 1e-9);  // weights 4 : 1
  EXPECT_EQ(points[0].num_measurements, 2U);
  EXPECT_NEAR(points[0].scatter_m, std::sqrt((0.004 * 0.004 + 0.016 * 0.016) / 2), 1e-9);
  EXPECT_NEAR(points[0].sigma_m, 1 / std::sqrt(1e4 + 2.5e3), 1e-9);
  EXPECT_EQ(points[0].farthest, "");
  EXPECT_EQ(points[1].sigma_m, 0.02);
  EXPECT_EQ(points[1].scatter_m, 0);
}

TEST(AverageMeasurements, NamesTheOneThatIsAnotherPoint) {
  std::vector<PointMeasurement> measurements;
  for (int i = 0; i < 4; ++i) measurements.push_back({"A", {0.01 * i, 0, 0}, 0.02, "frame " + std::to_string(i)});
  measurements[2].p_map.y() = 0.7;
  const std::vector<ObservedPoint> points = average_measurements(measurements);
  ASSERT_EQ(points.size(), 1U);
  EXPECT_EQ(points[0].farthest, "frame 2");
  EXPECT_GT(points[0].sigma_m, 0.05);
}

}  // namespace
}  // namespace camloc::mapping
