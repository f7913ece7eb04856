// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The same problems solved by Ceres with automatic derivatives: both must end in the same minimum.
#include <gtest/gtest.h>

#include "tests/optimize/generated_bundle.h"
#ifdef CAMLOC_HAS_CERES
#include "tests/optimize/ceres_bundle.h"
#endif

namespace camloc {
namespace {

void expect_same_minimum([[maybe_unused]] const testing::BundleWorldOptions& world_options, [[maybe_unused]] bool use_depth,
                         [[maybe_unused]] unsigned seed) {
#ifdef CAMLOC_HAS_CERES
  std::mt19937 rng(seed);
  testing::BundleWorld world = testing::make_bundle_world(rng, world_options);
  world.options.use_depth = use_depth;
  world.options.max_iterations = 100;
  world.options.min_relative_decrease = 1e-9;
  testing::CeresBundle oracle(world.options, world.start);
  const ceres::Solver::Summary summary = oracle.solve(world.options, ceres::DENSE_SCHUR);
  const BundleReport report = adjust_bundle(world.options, &world.start);
  EXPECT_NEAR(report.initial_cost, 2 * summary.initial_cost, 1e-6 * report.initial_cost);
  EXPECT_NEAR(report.final_cost, 2 * summary.final_cost, 1e-4 * report.final_cost);
  const std::vector<Rigid3> poses = oracle.poses();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Vector6d error = pose_error(poses[i], world.start.T_map_camera[i]);
    EXPECT_LT(error.head<3>().norm(), 2e-3);
    EXPECT_LT(error.tail<3>().norm(), 1e-3);
  }
#else
  GTEST_SKIP() << "Ceres (libceres-dev) was not found when this was built";
#endif
}

TEST(BundleOracle, RoomWithDepth) { expect_same_minimum({.num_landmarks = 1500}, true, 1); }

// With depth throughout: without, Ceres moves the landmarks of outliers behind the camera, where ours leaves them out.
TEST(BundleOracle, RoomWithOutliers) { expect_same_minimum({.num_landmarks = 1000, .outlier_ratio = 0.05}, true, 2); }

TEST(BundleOracle, RoomWithLittleDepth) { expect_same_minimum({.num_landmarks = 1500, .depth_ratio = 0.3}, true, 6); }

TEST(BundleOracle, LocalAdjustment) { expect_same_minimum({.num_landmarks = 1500, .num_fixed = 12}, true, 3); }

// Without depth the far ends are weak: many landmarks and several known cameras make the minimum a sharp one.
TEST(BundleOracle, PixelsOnly) { expect_same_minimum({.num_landmarks = 3000, .num_fixed = 8}, false, 4); }

TEST(BundleOracle, Corridor) { expect_same_minimum({.num_cameras = 60, .num_landmarks = 3000, .corridor_m = 30}, true, 5); }

}  // namespace
}  // namespace camloc
