// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Bundle adjustment on generated rooms whose truth is known.
#include "core/optimize/bundle_adjustment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "tests/optimize/generated_bundle.h"

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

/// Everything that comes out, bit by bit.
void expect_same_bits(const BundleProblem& a, const BundleProblem& b) {
  for (std::size_t i = 0; i < a.T_map_camera.size(); ++i) {
    EXPECT_EQ(a.T_map_camera[i].rotation.coeffs(), b.T_map_camera[i].rotation.coeffs());
    EXPECT_EQ(a.T_map_camera[i].translation, b.T_map_camera[i].translation);
  }
  for (std::size_t i = 0; i < a.landmarks_m.size(); ++i) EXPECT_EQ(a.landmarks_m[i], b.landmarks_m[i]);
}

void expect_finite(const BundleProblem& problem) {
  for (const Rigid3& T : problem.T_map_camera) EXPECT_TRUE(T.translation.allFinite() && T.rotation.coeffs().allFinite());
  for (const Eigen::Vector3d& X : problem.landmarks_m) EXPECT_TRUE(X.allFinite());
}

TEST(BundleAdjustment, LocalAdjustmentMovesOnlyWhatIsFree) {
  std::mt19937 rng(3);
  BundleWorldOptions options;
  options.num_landmarks = 1500;
  options.num_fixed = 14;
  BundleWorld world = make_bundle_world(rng, options);
  world.options.max_iterations = 5;
  const BundleReport report = adjust_bundle(world.options, &world.start);
  EXPECT_FALSE(report.is_sparse);
  for (std::size_t i = 0; i < 14; ++i) {
    EXPECT_EQ(world.start.T_map_camera[i].translation, world.truth.T_map_camera[i].translation);
    EXPECT_EQ(world.start.T_map_camera[i].rotation.coeffs(), world.truth.T_map_camera[i].rotation.coeffs());
  }
  for (std::size_t i = 14; i < 20; ++i) {
    EXPECT_LT(pose_error(world.truth.T_map_camera[i], world.start.T_map_camera[i]).head<3>().norm(), 0.03);
  }
}

TEST(BundleAdjustment, OutliersDoNotPullCamerasFar) {
  std::mt19937 rng(4);
  BundleWorldOptions options;
  options.num_landmarks = 3000;
  options.outlier_ratio = 0.1;
  BundleWorld world = make_bundle_world(rng, options);
  BundleProblem without_kernel = world.start;
  adjust_bundle(world.options, &world.start);
  EXPECT_LT(camera_error_m(world.start, world.truth), 0.04);
  BundleOptions wide = world.options;
  wide.pixel_kernel_sigmas = wide.depth_kernel_sigmas = 1e6;
  adjust_bundle(wide, &without_kernel);
  EXPECT_GT(camera_error_m(without_kernel, world.truth), 2 * camera_error_m(world.start, world.truth));
}

TEST(BundleAdjustment, ResidualsTellTheOutliers) {
  std::mt19937 rng(5);
  BundleWorldOptions options;
  options.outlier_ratio = 0.05;
  const BundleWorld world = make_bundle_world(rng, options);
  const std::vector<BundleResidual> residuals = bundle_residuals(world.options, world.truth);
  ASSERT_EQ(residuals.size(), world.truth.observations.size());
  double inlier_pixel = 0, inlier_depth = 0, num_inliers = 0;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    if (world.is_outlier[i] != 0) continue;
    inlier_pixel += residuals[i].pixel_sigmas * residuals[i].pixel_sigmas;
    inlier_depth += residuals[i].depth_sigmas * residuals[i].depth_sigmas;
    num_inliers += 1;
  }
  EXPECT_NEAR(inlier_pixel / num_inliers, 2.0, 0.2);
  EXPECT_NEAR(inlier_depth / num_inliers, 1.0, 0.3);  // the noise is drawn by the true distance, judged by the measured one
}

TEST(BundleAdjustment, DepthMakesItBetter) {
  std::mt19937 rng(6);
  BundleWorldOptions options;
  options.num_cameras = 40;
  options.num_landmarks = 2000;
  options.num_fixed = 2;  // they give the comparison its scale
  options.corridor_m = 20;
  BundleWorld world = make_bundle_world(rng, options);
  world.options.max_iterations = 50;
  BundleProblem pixels_only = world.start;
  adjust_bundle(world.options, &world.start);
  BundleOptions without_depth = world.options;
  without_depth.use_depth = false;
  adjust_bundle(without_depth, &pixels_only);
  expect_finite(pixels_only);
  EXPECT_LT(camera_error_m(world.start, world.truth), 0.7 * camera_error_m(pixels_only, world.truth));
}

TEST(BundleAdjustment, DenseAndSparseAgree) {
  std::mt19937 rng(7);
  BundleWorldOptions options;
  options.num_cameras = 60;
  options.num_landmarks = 3000;
  options.corridor_m = 30;
  BundleWorld world = make_bundle_world(rng, options);
  BundleProblem sparse = world.start;
  const BundleReport dense_report = adjust_bundle(world.options, &world.start);
  BundleOptions sparse_options = world.options;
  sparse_options.max_dense_cameras = 10;
  const BundleReport sparse_report = adjust_bundle(sparse_options, &sparse);
  EXPECT_FALSE(dense_report.is_sparse);
  EXPECT_TRUE(sparse_report.is_sparse);
  EXPECT_EQ(dense_report.num_iterations, sparse_report.num_iterations);
  EXPECT_NEAR(dense_report.final_cost, sparse_report.final_cost, 1e-9 * dense_report.final_cost);
  EXPECT_LT(camera_error_m(world.start, sparse), 1e-6);
}

TEST(BundleAdjustment, PriorsPullTheMapToControlPoints) {
  std::mt19937 rng(8);
  BundleWorldOptions options;
  options.num_fixed = 0;
  BundleWorld world = make_bundle_world(rng, options);
  // The whole map sits beside the site.
  const Rigid3 T_off{exp_so3({0.01, -0.02, 0.03}), {0.3, -0.2, 0.1}};
  for (Rigid3& T : world.start.T_map_camera) T = T_off * T;
  for (Eigen::Vector3d& X : world.start.landmarks_m) X = T_off * X;
  for (std::uint32_t l = 0; l < 20; ++l) world.start.priors.push_back({29 * l, world.truth.landmarks_m[29 * l], 0.005});
  world.start.priors.push_back({3, {1, 2, 3}, 0.0});                                          // unusable:
  world.start.priors.push_back({3, {std::numeric_limits<double>::quiet_NaN(), 2, 3}, 0.01});  // left out
  world.options.max_iterations = 50;
  const BundleReport report = adjust_bundle(world.options, &world.start);
  EXPECT_TRUE(report.is_converged);
  EXPECT_LT(camera_error_m(world.start, world.truth), 0.06);
  for (std::uint32_t l = 0; l < 20; ++l) { EXPECT_LT((world.start.landmarks_m[29 * l] - world.truth.landmarks_m[29 * l]).norm(), 0.02); }
}

TEST(BundleAdjustment, LandmarksSeenOnceFollowTheirCamera) {
  std::mt19937 rng(9);
  BundleWorld world = make_bundle_world(rng, {});
  BundleProblem alone = world.start;
  const auto num_landmarks = static_cast<std::uint32_t>(alone.landmarks_m.size());
  alone.landmarks_m.insert(alone.landmarks_m.end(), 3, Eigen::Vector3d(1, 2, 3));
  alone.observations.push_back({5, num_landmarks, 0.1F, -0.2F, 2.0F, 1.0F});
  alone.observations.push_back({6, num_landmarks + 1, 0.1F, -0.2F, 0.0F, 1.0F});
  adjust_bundle(world.options, &world.start);
  adjust_bundle(world.options, &alone);
  EXPECT_LT(camera_error_m(alone, world.start), 1e-15);
  const Eigen::Vector3d seen = alone.T_map_camera[5] * Eigen::Vector3d(2.0 * 0.1F, 2.0 * -0.2F, 2.0);
  EXPECT_LT((alone.landmarks_m[num_landmarks] - seen).norm(), 1e-12);
  EXPECT_EQ(alone.landmarks_m[num_landmarks + 1], Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(alone.landmarks_m[num_landmarks + 2], Eigen::Vector3d(1, 2, 3));
}

// It is where the surveyor says; what a single depth says of it would be off by 2 m.
TEST(BundleAdjustment, ASurveyedPointIsNotMovedByASingleDepth) {
  std::mt19937 rng(9);
  BundleWorld world = make_bundle_world(rng, {});
  const auto surveyed = static_cast<std::uint32_t>(world.start.landmarks_m.size());
  const Eigen::Vector3d position_m = world.truth.T_map_camera[0] * Eigen::Vector3d(0.1, -0.2, 4.0);
  world.start.landmarks_m.push_back(position_m);
  world.start.observations.push_back({0, surveyed, 0.025F, -0.05F, 2.0F, 1.0F});
  world.start.priors.push_back({surveyed, position_m, 0.005});
  adjust_bundle(world.options, &world.start);
  EXPECT_LT((world.start.landmarks_m[surveyed] - position_m).norm(), 0.01);
}

// Levenberg-Marquardt goes on after a step that made it worse: from starts so bad that there are some.
TEST(BundleAdjustment, AStepThatFailsIsTriedShorter) {
  int num_recovered = 0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    std::mt19937 rng(seed);
    BundleWorldOptions o;
    o.num_cameras = 6;
    o.num_landmarks = 200;
    o.position_error_m = o.landmark_error_m = 1.0;
    o.rotation_error_rad = 0.5;
    BundleWorld world = make_bundle_world(rng, o);
    world.options.max_iterations = 60;
    std::vector<double> costs;
    adjust_bundle(world.options, &world.start, [&](int, double cost) {
      costs.push_back(cost);
      return true;
    });
    const auto failed = std::adjacent_find(costs.begin(), costs.end());
    if (failed != costs.end() && costs.back() < *failed) ++num_recovered;
  }
  EXPECT_GE(num_recovered, 2);
}

TEST(BundleAdjustment, OneLandmarkTwiceInAnImageCountsTwice) {
  std::mt19937 rng(10);
  BundleWorld world = make_bundle_world(rng, {});
  BundleProblem doubled = world.start, halved = world.start;
  doubled.observations.clear();
  for (const BundleObservation& o : world.start.observations) doubled.observations.insert(doubled.observations.end(), 2, o);
  const BundleReport report = adjust_bundle(world.options, &doubled);
  const BundleReport single_report = adjust_bundle(world.options, &halved);
  EXPECT_NEAR(report.final_cost, 2 * single_report.final_cost, 1e-6 * report.final_cost);
  EXPECT_LT(camera_error_m(doubled, halved), 1e-6);
}

TEST(BundleAdjustment, EmptyProblem) {
  BundleProblem problem;
  const BundleReport report = adjust_bundle({}, &problem);
  EXPECT_TRUE(report.is_converged);
  EXPECT_EQ(report.final_cost, 0);
  EXPECT_TRUE(bundle_residuals({}, problem).empty());
}

TEST(BundleAdjustment, AllCamerasFixedMovesLandmarksOnly) {
  std::mt19937 rng(11);
  BundleWorldOptions options;
  options.num_fixed = options.num_cameras;
  BundleWorld world = make_bundle_world(rng, options);
  const BundleReport report = adjust_bundle(world.options, &world.start);
  EXPECT_EQ(camera_error_m(world.start, world.truth), 0);
  EXPECT_LT(report.final_cost, 0.5 * report.initial_cost);
}

TEST(BundleAdjustment, WhatIsNotFiniteOrBehindIsLeftOut) {
  std::mt19937 rng(12);
  BundleWorldOptions options;
  options.num_landmarks = 1500;
  BundleWorld world = make_bundle_world(rng, options);
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  std::vector<BundleObservation>& observations = world.start.observations;
  observations[10].depth_m = kNaN;
  observations[20].depth_m = -1;
  observations[30].x = kNaN;
  observations[40].y = std::numeric_limits<float>::infinity();
  observations[50].sigma_px = 0;
  observations[60].sigma_px = kNaN;
  const std::uint32_t behind = observations[70].landmark;
  const Rigid3& T_map_camera = world.start.T_map_camera[observations[70].camera];
  world.start.landmarks_m[behind] = T_map_camera * Eigen::Vector3d(0, 0, -1);
  const std::uint32_t lost = observations[400].landmark;
  world.start.landmarks_m[lost].setConstant(std::numeric_limits<double>::quiet_NaN());
  const std::vector<BundleResidual> residuals = bundle_residuals(world.options, world.start);
  EXPECT_EQ(residuals[70].pixel_sigmas, 1e9F);
  EXPECT_EQ(residuals[30].pixel_sigmas, 1e9F);
  EXPECT_EQ(residuals[400].pixel_sigmas, 1e9F);
  EXPECT_EQ(residuals[10].depth_sigmas, 0);
  const BundleReport report = adjust_bundle(world.options, &world.start);
  EXPECT_TRUE(std::isfinite(report.initial_cost));
  EXPECT_LE(report.final_cost, report.initial_cost);
  EXPECT_TRUE(world.start.landmarks_m[lost].array().isNaN().all());
  world.start.landmarks_m[lost].setZero();
  expect_finite(world.start);
  EXPECT_LT(camera_error_m(world.start, world.truth), 0.04);
}

TEST(BundleAdjustment, CameraThatSeesNothingKeepsItsPlace) {
  std::mt19937 rng(13);
  BundleWorld world = make_bundle_world(rng, {});
  const Rigid3 lonely{exp_so3({1, 2, 3}), {7, 8, 9}};
  world.start.T_map_camera.push_back(lonely);
  world.start.is_camera_fixed.push_back(0);
  adjust_bundle(world.options, &world.start);
  EXPECT_EQ(world.start.T_map_camera.back().translation, lonely.translation);
  expect_finite(world.start);
}

// Camera 7 sees nothing: a link to camera 4 says where it is.
TEST(BundleAdjustment, LinksHoldWhatNoLandmarkHolds) {
  for (const std::uint32_t max_dense_cameras : {250U, 0U}) {
    std::mt19937 rng(11);
    BundleWorldOptions o;
    o.noise_px = 0.3;
    BundleWorld world = make_bundle_world(rng, o);
    world.options.max_dense_cameras = max_dense_cameras;
    std::erase_if(world.start.observations, [](const BundleObservation& observation) { return observation.camera == 7; });
    const Rigid3 T_4_7 = world.truth.T_map_camera[4].inverse() * world.truth.T_map_camera[7];
    world.start.links = {{7, 4, T_4_7.inverse(), 1e-6 * Matrix6d::Identity()}};
    const BundleReport report = adjust_bundle(world.options, &world.start);
    EXPECT_EQ(report.is_sparse, max_dense_cameras == 0);
    const Rigid3 found = world.start.T_map_camera[4].inverse() * world.start.T_map_camera[7];
    EXPECT_LT((found.translation - T_4_7.translation).norm(), 1e-4);
    EXPECT_LT(rotation_distance_rad(found.rotation, T_4_7.rotation), 1e-4);
    EXPECT_LT(camera_error_m(world.start, world.truth), 0.01);
  }
}

TEST(BundleAdjustment, AWrongLinkIsOutvotedAndOneThatMakesNoSenseIgnored) {
  std::mt19937 rng(12);
  BundleWorld world = make_bundle_world(rng, {});
  BundleProblem alone = world.start, linked = world.start;
  const Rigid3 T_4_5 = world.truth.T_map_camera[4].inverse() * world.truth.T_map_camera[5];
  linked.links.push_back({4, 5, T_4_5 * Rigid3{Eigen::Quaterniond::Identity(), {0.5, 0, 0}}, 1e-4 * Matrix6d::Identity()});
  linked.links.push_back({2, 3, {}, Matrix6d::Zero()});
  linked.links.push_back({2, 3, {}, Matrix6d::Constant(std::numeric_limits<double>::quiet_NaN())});
  adjust_bundle(world.options, &alone);
  adjust_bundle(world.options, &linked);
  EXPECT_LT(camera_error_m(linked, alone), 0.002);
}

TEST(BundleAdjustment, SameBitsTwice) {
  std::mt19937 rng(14);
  BundleWorldOptions options;
  options.outlier_ratio = 0.1;
  BundleWorld world = make_bundle_world(rng, options);
  for (const std::uint32_t max_dense_cameras : {250U, 5U}) {
    world.options.max_dense_cameras = max_dense_cameras;
    BundleProblem first = world.start, second = world.start;
    adjust_bundle(world.options, &first);
    adjust_bundle(world.options, &second);
    expect_same_bits(first, second);
  }
}

TEST(BundleAdjustment, StopsWhenAsked) {
  std::mt19937 rng(15);
  BundleWorld world = make_bundle_world(rng, {});
  std::vector<double> costs;
  const BundleReport report = adjust_bundle(world.options, &world.start, [&](int iteration, double cost) {
    costs.push_back(cost);
    return iteration < 2;
  });
  EXPECT_TRUE(report.is_stopped);
  EXPECT_FALSE(report.is_converged);
  EXPECT_EQ(report.num_iterations, 2);
  ASSERT_EQ(costs.size(), 2U);
  EXPECT_EQ(costs[1], report.final_cost);
  EXPECT_LT(report.final_cost, report.initial_cost);
}

}  // namespace
}  // namespace camloc
