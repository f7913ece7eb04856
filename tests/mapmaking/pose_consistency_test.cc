// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapmaking/pose_consistency.h"

#include <gtest/gtest.h>

#include <random>

namespace camloc {
namespace {

RgbdCamera wide_camera() {
  RgbdCamera camera;
  camera.color.width = 640;
  camera.color.height = 480;
  camera.color.fx = camera.color.fy = 525;
  camera.color.cx = 319.5;
  camera.color.cy = 239.5;
  camera.depth = camera.color;
  return camera;
}

/// Views along a line, there and back: the second half looks at the same points as the first. Recorded poses are off by
/// the given standard deviations per axis, independently for each view.
PoseConsistencyEstimate estimate_with(double error_m, double error_rad) {
  std::mt19937_64 random(21);
  std::uniform_real_distribution<double> x(-1.2, 2.4), y(-0.8, 0.8), z(1.5, 3.5);
  std::normal_distribution<double> normal;
  std::vector<Eigen::Vector3d> points;
  std::vector<Descriptor> descriptors;
  for (int i = 0; i < 500; ++i) {
    points.emplace_back(x(random), y(random), z(random));
    descriptors.push_back({{random(), random(), random(), random()}});
  }
  const RgbdCamera camera = wide_camera();
  PoseConsistency consistency(camera, PyramidLevels(1.2F, 8), {});
  const auto noise3 = [&](double sigma) {
    return Eigen::Vector3d(sigma * Eigen::Vector3d(normal(random), normal(random), normal(random)));
  };
  for (int i = 0; i < 120; ++i) {
    const double along = i < 60 ? 0.02 * i : 0.02 * (120 - i) + 0.15;
    const Rigid3 T_map_camera{exp_so3({0.002 * i, 0, 0.001 * i}), {along, 0.03 * (i % 5), 0}};
    FrameFeatures view;
    for (std::size_t p = 0; p < points.size(); ++p) {
      const Eigen::Vector3d p_camera = T_map_camera.inverse() * points[p];
      Eigen::Vector2d pixel = camera.color.project(p_camera);
      pixel += 0.4 * Eigen::Vector2d(normal(random), normal(random));
      if (pixel.x() < 0 || pixel.y() < 0 || pixel.x() > 639 || pixel.y() > 479) continue;
      Keypoint keypoint;
      keypoint.u = static_cast<float>(pixel.x());
      keypoint.v = static_cast<float>(pixel.y());
      view.features.keypoints.push_back(keypoint);
      view.features.descriptors.push_back(descriptors[p]);
      view.normalized.push_back(camera.color.undistort(pixel).cast<float>());
      view.depth_m.push_back(static_cast<float>(p_camera.z() + camera.depth_noise.sigma_m(p_camera.z()) * normal(random)));
    }
    view.T_map_camera = {exp_so3(noise3(error_rad)) * T_map_camera.rotation, T_map_camera.translation + noise3(error_m)};
    consistency.add_view(view);
  }
  return consistency.estimate();
}

TEST(PoseConsistency, ExactPosesHaveNearlyNone) {
  const auto estimate = estimate_with(0, 0);
  EXPECT_GE(estimate.num_pairs, 40U);
  EXPECT_LT(estimate.sigma_m, 0.003);
  EXPECT_LT(estimate.sigma_rad, 0.0015);
}

TEST(PoseConsistency, FindsTheDisagreementOfAPair) {
  const auto estimate = estimate_with(0.02, 0.01);
  EXPECT_GE(estimate.num_pairs, 40U);
  // Both views of a pair are off, and a rotation error of one moves the other sideways by at most 0.7 m times it.
  EXPECT_NEAR(estimate.sigma_m, 0.02 * std::sqrt(2.0), 0.008);
  EXPECT_NEAR(estimate.sigma_rad, 0.01 * std::sqrt(2.0), 0.004);
}

TEST(PoseConsistency, IsUnknownWithoutPairs) {
  const auto estimate = PoseConsistency(wide_camera(), PyramidLevels(1.2F, 8), {}).estimate();
  EXPECT_EQ(estimate.num_pairs, 0U);
  EXPECT_EQ(estimate.sigma_m, 0.0);
}

TEST(ExcessSigma, IsWhatTheVariancesLeaveUnexplained) {
  std::mt19937_64 random(22);
  std::normal_distribution<double> normal;
  std::vector<double> errors, variances;
  for (int i = 0; i < 20000; ++i) {
    const double own = 0.5 + 0.001 * (i % 1000);
    errors.push_back(std::hypot(own, 2.0) * normal(random));
    variances.push_back(own * own);
  }
  EXPECT_NEAR(excess_sigma(errors, variances), 2.0, 0.06);
  for (int i = 0; i < 4000; ++i) errors[static_cast<std::size_t>(5 * i)] = 1e6;  // outliers
  EXPECT_NEAR(excess_sigma(errors, variances), 2.0, 1.0);
  for (double& v : variances) v *= 100;
  EXPECT_EQ(excess_sigma(std::vector<double>(variances.size(), 0.5), variances), 0.0);
}

}  // namespace
}  // namespace camloc
