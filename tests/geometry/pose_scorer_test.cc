// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The scoring kernel against a plain loop in doubles.
#include "core/geometry/pose_scorer.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/geometry/generated.h"

namespace camloc {
namespace {

constexpr float kNoLimit = std::numeric_limits<float>::infinity();
constexpr double kMaxError_px = 5.0, kRelativeDepth = 0.15;

ScoredPose scored(const Rigid3& T_camera_map, const Eigen::Vector3d& centre) {
  ScoredPose pose;
  const Eigen::Matrix3d R = T_camera_map.rotation.toRotationMatrix();
  const Eigen::Vector3d t = T_camera_map * centre;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) pose.R[3 * row + column] = static_cast<float>(R(row, column));
    pose.t[row] = static_cast<float>(t[row]);
  }
  return pose;
}

double plain_cost(const Correspondences& pairs, std::size_t n, const Rigid3& T_camera_map) {
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector3d p = T_camera_map * Eigen::Vector3d(pairs.X[i], pairs.Y[i], pairs.Z[i]);
    const double du = 525 * (p.x() / p.z() - pairs.x[i]), dv = 525 * (p.y() / p.z() - pairs.y[i]);
    const double depth = pairs.depth_m[i];
    const bool is_inlier = p.z() > 0.05 && du * du + dv * dv < kMaxError_px * kMaxError_px &&
                           (depth <= 0 || std::abs(p.z() - depth) <= kRelativeDepth * depth);
    sum += is_inlier ? du * du + dv * dv : kMaxError_px * kMaxError_px;
  }
  return sum;
}

TEST(PoseScorer, AgreesWithAPlainLoopForEverySize) {
  std::mt19937 rng(1);
  testing::SceneOptions options;
  options.outlier_ratio = 0.4;
  PoseScorer scorer(300);
  for (const int n : {1, 7, 8, 9, 63, 64, 65, 200, 300}) {
    options.num_pairs = n;
    options.has_depth = n % 2 == 0;
    const testing::Scene scene = testing::make_scene(rng, options);
    const std::size_t size = scene.pairs.size();
    scorer.set_pairs(scene.pairs, size, 525, kMaxError_px, kRelativeDepth);
    const std::size_t padding = (8 - size % 8) % 8;
    for (const double step_m : {0.0, 0.003, 0.02, 3.0}) {
      const Rigid3 T_camera_map = testing::disturbed(rng, scene.T_map_camera, step_m, 0.1 * step_m).inverse();
      const ScoredPose pose = scored(T_camera_map, scorer.centre());
      const double expected = plain_cost(scene.pairs, size, T_camera_map);
      EXPECT_NEAR(scorer.cost(pose, kNoLimit), expected + 25.0 * static_cast<double>(padding), 0.01 * static_cast<double>(size));
      double sum = 0;
      for (std::size_t i = 0; i < size; ++i) sum += static_cast<double>(scorer.pair_cost(pose, i).squared_error_px);
      EXPECT_NEAR(sum, expected, 0.01 * static_cast<double>(size));
    }
  }
}

TEST(PoseScorer, EarlyExitIsExact) {
  std::mt19937 rng(2);
  testing::SceneOptions options;
  options.outlier_ratio = 0.5;
  const testing::Scene scene = testing::make_scene(rng, options);
  PoseScorer scorer(200);
  scorer.set_pairs(scene.pairs, 200, 525, kMaxError_px, 0);
  for (int i = 0; i < 200; ++i) {
    const Rigid3 T_camera_map = testing::disturbed(rng, scene.T_map_camera, 0.05, 0.01).inverse();
    const ScoredPose pose = scored(T_camera_map, scorer.centre());
    const float full = scorer.cost(pose, kNoLimit);
    EXPECT_GE(scorer.cost(pose, 0.5F * full), 0.5F * full);
    EXPECT_GE(scorer.cost(pose, full), full) << "a tie does not win";
    EXPECT_EQ(scorer.cost(pose, std::nextafter(full, kNoLimit)), full);
  }
}

TEST(PoseScorer, PointsBehindTheCameraAreOutliers) {
  Correspondences pairs(1);
  pairs.add(0, 0, 0, 0, -2, 0, 1, 0, 0, 0);  // projects onto the same image point as one in front
  PoseScorer scorer(1);
  scorer.set_pairs(pairs, 1, 525, kMaxError_px, 0);
  EXPECT_FALSE(scorer.pair_cost(scored({}, scorer.centre()), 0).is_inlier);
  EXPECT_EQ(scorer.cost(scored({}, scorer.centre()), kNoLimit), 8 * 25.0F);
}

}  // namespace
}  // namespace camloc
