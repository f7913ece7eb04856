// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Bundle adjustment on generated rooms whose truth is known.
#include "core/slam/bundle_adjustment.h"

#include <gtest/gtest.h>

#include "tests/slam/generated_bundle.h"

namespace camloc {
namespace {

using testing::BundleWorld;
using testing::BundleWorldOptions;
using testing::camera_error_m;
using testing::make_bundle_world;

TEST(BundleAdjustment, FindsTheTruthWithoutNoise) {
  std::mt19937 rng(1);
  BundleWorldOptions options;
  options.noise_px = 0;
  BundleWorld world = make_bundle_world(rng, options);
  for (BundleObservation& o : world.start.observations) {
    const Rigid3 T_camera_map = world.truth.T_map_camera[o.camera].inverse();
    o.depth_m = static_cast<float>((T_camera_map * world.truth.landmarks_m[o.landmark]).z());
  }
  const BundleReport report = adjust_bundle(world.options, &world.start);
  EXPECT_TRUE(report.is_converged);
  EXPECT_LT(report.final_cost, 1e-3);
  EXPECT_LT(camera_error_m(world.start, world.truth), 1e-5);
}

TEST(BundleAdjustment, FindsTheTruthWithNoise) {
  std::mt19937 rng(2);
  BundleWorldOptions options;
  options.num_landmarks = 3000;
  BundleWorld world = make_bundle_world(rng, options);
  const double before = camera_error_m(world.start, world.truth);
  const BundleReport report = adjust_bundle(world.options, &world.start);
  BundleProblem from_truth = world.truth;
  const BundleReport truth_report = adjust_bundle(world.options, &from_truth);
  EXPECT_TRUE(report.is_converged);
  EXPECT_LE(report.num_iterations, 8);
  EXPECT_LT(report.final_cost, truth_report.initial_cost);
  EXPECT_NEAR(report.final_cost, truth_report.final_cost, 1e-4 * truth_report.final_cost);
  EXPECT_LT(camera_error_m(world.start, from_truth), 1e-3);
  EXPECT_GT(before, 0.08);
  EXPECT_LT(camera_error_m(world.start, world.truth), 0.02);
}

}  // namespace
}  // namespace camloc
