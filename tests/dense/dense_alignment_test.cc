// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Dense alignment on thumbnails of a box, the motion known.
#include "core/dense/dense_alignment.h"

#include <gtest/gtest.h>

#include "core/slam/dead_reckoning.h"
#include "tests/dense/generated_thumbnail.h"
#include "tests/slam/generated_walk.h"

namespace camloc {
namespace {

using testing::BoxRenderer;
using testing::looking;

const Eigen::Vector3d kLow(-3, -2.5, 0), kHigh(3, 2.5, 2.8);

struct AlignedScenery {
  testing::World world;
  testing::Viewer viewer{world};
  BoxRenderer renderer{viewer.camera(), kLow, kHigh};
  DenseAligner aligner{viewer.camera()};

  /// Error of the motion between two true poses, given a prediction that is off by `change` in the axes of the second.
  Vector6d error(const Rigid3& T_world_a, const Rigid3& T_world_b, const Vector6d& change, DenseAlignment* found) {
    const Rigid3 T_a_b = T_world_a.inverse() * T_world_b;
    const Rigid3 predicted = T_a_b * Rigid3{exp_so3(change.tail<3>()), change.head<3>()};
    *found = aligner.align(renderer.see(T_world_a), renderer.see(T_world_b), predicted, diagonal_covariance(0.02, 0.04));
    const Rigid3 T_error = T_a_b.inverse() * found->T_a_b;
    Vector6d error;
    error << T_error.translation, log_so3(T_error.rotation);
    return error;
  }
};

Vector6d change_of(double x, double y, double z, double rx, double ry, double rz) {
  Vector6d change;
  change << x, y, z, rx, ry, rz;
  return change;
}

TEST(DenseAlignment, FindsTheMotionInACorner) {
  AlignedScenery scenery;
  DenseAlignment found;
  const Rigid3 a = looking({1.2, 0.9, 1.3}, 0.7, -0.2), b = looking({1.25, 0.93, 1.28}, 0.78, -0.22);
  const Vector6d error = scenery.error(a, b, change_of(0.02, -0.015, 0.01, 0.015, -0.02, 0.01), &found);
  ASSERT_TRUE(found.is_aligned);
  EXPECT_LT(error.head<3>().norm(), 0.004);
  EXPECT_LT(error.tail<3>().norm(), 0.003);
  EXPECT_LT(std::sqrt(found.covariance.topLeftCorner<3, 3>().trace()), 0.01);
}

TEST(DenseAlignment, AFaintTextureSaysWhereAlongTheWall) {
  AlignedScenery scenery;
  scenery.renderer.vignetting = 0.35;  // ten times what the texture is
  DenseAlignment found;
  const Rigid3 a = looking({1.8, 0.2, 1.4}, 0.0), b = looking({1.82, 0.25, 1.4}, 0.09, -0.02);
  const Vector6d error = scenery.error(a, b, change_of(0.015, 0.01, 0.01, 0.01, 0.01, -0.01), &found);
  ASSERT_TRUE(found.is_aligned);
  EXPECT_LT(error.head<3>().norm(), 0.006);
  EXPECT_LT(error.tail<3>().norm(), 0.005);
}

// In front of a plane without texture depth says how far and how tilted; the rest stays as predicted, and as uncertain.
TEST(DenseAlignment, ABareWallLeavesThePrediction) {
  AlignedScenery scenery;
  scenery.renderer.contrast = 0;
  DenseAlignment found;
  const Rigid3 a = looking({1.8, 0.2, 1.4}, 0.0), b = looking({1.82, 0.25, 1.4}, 0.05);
  const Vector6d error = scenery.error(a, b, change_of(0.015, 0.01, 0.01, 0.01, 0.01, -0.01), &found);
  ASSERT_TRUE(found.is_aligned);
  EXPECT_LT(std::abs(error[2]), 0.003);          // distance
  EXPECT_LT(error.segment<2>(3).norm(), 0.002);  // tilt
  EXPECT_NEAR(error[0], 0.015, 0.01);
  EXPECT_NEAR(error[1], 0.010, 0.01);
  EXPECT_NEAR(error[5], -0.01, 0.01);
  EXPECT_GT(std::sqrt(found.covariance(0, 0)), 0.008);  // sigma of the prediction: 0.02 m, 0.04 rad
  EXPECT_LT(std::sqrt(found.covariance(2, 2)), 0.004);
  EXPECT_GT(std::sqrt(found.covariance(5, 5)), 0.015);
  EXPECT_LT(std::sqrt(found.covariance(4, 4)), 0.006);
}

TEST(DenseAlignment, RefusesWhatIsNotTheSameOrFarFromThePrediction) {
  AlignedScenery scenery;
  DenseAlignment found;
  const Rigid3 a = looking({1.2, 0.9, 1.3}, 0.7, -0.2);
  (void)scenery.error(a, looking({-1.0, -1.2, 1.4}, -2.2, 0.1), change_of(0, 0, 0, 0, 0, 0), &found);
  EXPECT_FALSE(found.is_aligned);
  (void)scenery.error(a, a, change_of(0.3, 0, 0.2, 0, 0, 0), &found);
  EXPECT_FALSE(found.is_aligned);
  EXPECT_FALSE(scenery.aligner.align({}, scenery.renderer.see(a), {}, diagonal_covariance(0.1, 0.1)).is_aligned);
  Thumbnail blind = scenery.renderer.see(a);
  std::fill(blind.depth.begin(), blind.depth.end(), std::uint16_t{0});
  EXPECT_FALSE(scenery.aligner.align(scenery.renderer.see(a), blind, {}, diagonal_covariance(0.1, 0.1)).is_aligned);
}

}  // namespace
}  // namespace camloc
