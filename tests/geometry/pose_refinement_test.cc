// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Refinement: accuracy, consistency of its covariance (NEES), focal scale, bad input, no allocation.
#include "core/geometry/pose_refinement.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <opencv2/calib3d.hpp>

#include "core/geometry/symmetric_system.h"
#include "tests/geometry/allocation_counter.h"
#include "tests/geometry/generated.h"

namespace camloc {
namespace {

using testing::make_scene;
using testing::Scene;
using testing::SceneOptions;

constexpr double kChiSquared95Of6 = 12.592;

struct Consistency {
  double mean_nees = 0;
  double share_inside_95 = 0;
};

Consistency measure_consistency(const SceneOptions& scene_options, const PoseRefinementOptions& options, int num_scenes) {
  std::mt19937 rng(11);
  Consistency consistency;
  for (int i = 0; i < num_scenes; ++i) {
    const Scene scene = make_scene(rng, scene_options);
    const Rigid3 start = testing::disturbed(rng, scene.T_map_camera, 0.01, 0.005);
    const PoseRefinementResult result = refine_pose(scene.pairs, start, scene_options.assumed_focal_px, options, nullptr);
    EXPECT_TRUE(result.is_converged);
    const double nees = squared_mahalanobis(pose_error(scene.T_map_camera, result.T_map_camera), result.covariance);
    consistency.mean_nees += nees / num_scenes;
    consistency.share_inside_95 += nees <= kChiSquared95Of6 ? 1.0 / num_scenes : 0.0;
  }
  return consistency;
}

void expect_consistent(const Consistency& consistency) {
  EXPECT_GE(consistency.mean_nees, 5.0);
  EXPECT_LE(consistency.mean_nees, 7.0);
  EXPECT_GE(consistency.share_inside_95, 0.92);
  EXPECT_LE(consistency.share_inside_95, 0.98);
}

TEST(PoseRefinement, ExactPairsGiveTheExactPose) {
  std::mt19937 rng(1);
  SceneOptions options;
  options.noise_px = 0;
  options.depth_noise = {0, 0};
  for (int i = 0; i < 50; ++i) {
    const Scene scene = make_scene(rng, options);
    const Rigid3 start = testing::disturbed(rng, scene.T_map_camera, 0.01, 0.005);
    const PoseRefinementResult result = refine_pose(scene.pairs, start, options.focal_px, {}, nullptr);
    ASSERT_TRUE(result.is_converged);
    // Landmarks are floats some metres from the origin: 2e-7 m each.
    EXPECT_LT(pose_error(scene.T_map_camera, result.T_map_camera).norm(), 1e-5);
    EXPECT_EQ(result.num_inliers, options.num_pairs);
    EXPECT_EQ(result.num_with_depth, options.num_pairs);
    EXPECT_LT(result.rms_px, 1e-2);
  }
}

TEST(PoseRefinement, CovarianceIsConsistentWithDepth) { expect_consistent(measure_consistency({}, {}, 800)); }

TEST(PoseRefinement, CovarianceIsConsistentWithoutDepth) {
  PoseRefinementOptions options;
  options.use_depth = false;
  expect_consistent(measure_consistency({}, options, 800));
}

TEST(PoseRefinement, CovarianceIsConsistentWithFewPairs) {
  SceneOptions scene;
  scene.num_pairs = 25;
  const Consistency consistency = measure_consistency(scene, {}, 800);
  // The scale max(1, chi^2) can only widen, and does so more often with few residuals.
  EXPECT_GE(consistency.mean_nees, 4.5);
  EXPECT_LE(consistency.mean_nees, 7.0);
  EXPECT_GE(consistency.share_inside_95, 0.92);
}

TEST(PoseRefinement, CovarianceIsConsistentWithFocalScale) {
  PoseRefinementOptions options;
  options.estimate_focal_scale = true;
  expect_consistent(measure_consistency({}, options, 800));
}

TEST(PoseRefinement, CovarianceWidensWhenNoiseIsLargerThanStated) {
  std::mt19937 rng(12);
  SceneOptions options;
  Scene scene = make_scene(rng, options);
  const PoseRefinementResult expected = refine_pose(scene.pairs, scene.T_map_camera, options.focal_px, {}, nullptr);
  for (float& sigma : scene.pairs.sigma_px) sigma = 0.5F;  // half of what it is
  PoseRefinementOptions pixels_only;
  pixels_only.use_depth = false;
  const PoseRefinementResult widened = refine_pose(scene.pairs, scene.T_map_camera, options.focal_px, pixels_only, nullptr);
  for (float& sigma : scene.pairs.sigma_px) sigma = 1.0F;
  const PoseRefinementResult reference = refine_pose(scene.pairs, scene.T_map_camera, options.focal_px, pixels_only, nullptr);
  EXPECT_NEAR(widened.covariance.trace() / reference.covariance.trace(), 1.0, 0.2);
  EXPECT_LT(expected.covariance.trace(), reference.covariance.trace()) << "depth adds information";
}

TEST(PoseRefinement, IsRobustToOutliersAndMarksThem) {
  std::mt19937 rng(13);
  SceneOptions options;
  options.outlier_ratio = 0.5;
  for (int i = 0; i < 30; ++i) {
    const Scene scene = make_scene(rng, options);
    std::vector<std::uint8_t> mask(scene.pairs.capacity());
    const Rigid3 start = testing::disturbed(rng, scene.T_map_camera, 0.01, 0.005);
    const PoseRefinementResult result = refine_pose(scene.pairs, start, options.focal_px, {}, &mask);
    ASSERT_TRUE(result.is_converged);
    const Vector6d error = pose_error(scene.T_map_camera, result.T_map_camera);
    EXPECT_LT(error.head<3>().norm(), 0.02);
    EXPECT_LT(error.tail<3>().norm(), 0.01);
    int num_marked = 0, num_wrong = 0;
    for (std::size_t k = 0; k < mask.size(); ++k) {
      num_marked += mask[k];
      num_wrong += mask[k] != scene.is_inlier[static_cast<std::size_t>(scene.pairs.landmark[k])] ? 1 : 0;
    }
    EXPECT_EQ(num_marked, result.num_inliers);
    EXPECT_LE(num_wrong, 6);
  }
}

TEST(PoseRefinement, DepthImprovesThePose) {
  std::mt19937 rng(14);
  SceneOptions options;
  options.num_pairs = 60;
  PoseRefinementOptions without_depth;
  without_depth.use_depth = false;
  double with_depth_sum = 0, without_depth_sum = 0;
  for (int i = 0; i < 200; ++i) {
    const Scene scene = make_scene(rng, options);
    const auto error_of = [&](const PoseRefinementOptions& o) {
      return pose_error(scene.T_map_camera, refine_pose(scene.pairs, scene.T_map_camera, 525, o, nullptr).T_map_camera).head<3>().norm();
    };
    with_depth_sum += error_of({});
    without_depth_sum += error_of(without_depth);
  }
  EXPECT_LT(with_depth_sum, 0.97 * without_depth_sum);
}

TEST(PoseRefinement, WithoutDepthIsAsAccurateAsOpenCv) {
  std::mt19937 rng(15);
  SceneOptions scene_options;
  PoseRefinementOptions options;
  options.use_depth = false;
  double ours = 0, theirs = 0;
  for (int i = 0; i < 100; ++i) {
    const Scene scene = make_scene(rng, scene_options);
    std::vector<cv::Point3f> points;
    std::vector<cv::Point2f> pixels;
    for (std::size_t k = 0; k < scene.pairs.size(); ++k) {
      points.emplace_back(scene.pairs.X[k], scene.pairs.Y[k], scene.pairs.Z[k]);
      pixels.emplace_back(scene.pairs.x[k], scene.pairs.y[k]);
    }
    cv::Vec3d r, t;
    ASSERT_TRUE(cv::solvePnP(points, pixels, cv::Mat::eye(3, 3, CV_64F), cv::noArray(), r, t));
    const Rigid3 T_map_camera = Rigid3{exp_so3({r[0], r[1], r[2]}), {t[0], t[1], t[2]}}.inverse();
    theirs += pose_error(scene.T_map_camera, T_map_camera).head<3>().norm();
    const Rigid3 start = testing::disturbed(rng, scene.T_map_camera, 0.01, 0.005);
    ours += pose_error(scene.T_map_camera, refine_pose(scene.pairs, start, 525, options, nullptr).T_map_camera).head<3>().norm();
  }
  EXPECT_LT(ours, 1.01 * theirs);
}

TEST(PoseRefinement, FindsAWrongFocalLength) {
  std::mt19937 rng(16);
  SceneOptions scene_options;
  scene_options.assumed_focal_px = 450;  // true: 525
  PoseRefinementOptions options;
  options.estimate_focal_scale = true;
  const double truth = scene_options.focal_px / scene_options.assumed_focal_px;
  constexpr int kScenes = 200;
  int num_within_2_sigma = 0;
  double mean = 0;
  for (int i = 0; i < kScenes; ++i) {
    const Scene scene = make_scene(rng, scene_options);
    // The start is what a solver finds that believes in the wrong focal length: some 30 cm off along the view.
    PoseRefinementOptions pixels_only;
    pixels_only.use_depth = false;
    pixels_only.max_error_px = 40;
    const Rigid3 start = refine_pose(scene.pairs, scene.T_map_camera, 450, pixels_only, nullptr).T_map_camera;
    const PoseRefinementResult result = refine_pose(scene.pairs, start, scene_options.assumed_focal_px, options, nullptr);
    ASSERT_TRUE(result.is_converged);
    EXPECT_NEAR(result.focal_scale, truth, 0.03);
    num_within_2_sigma += std::abs(result.focal_scale - truth) <= 2 * result.focal_scale_sigma ? 1 : 0;
    mean += result.focal_scale / kScenes;
    EXPECT_LT(result.focal_scale_sigma, 0.02);
  }
  EXPECT_NEAR(mean, truth, 0.002);
  EXPECT_GE(num_within_2_sigma, kScenes * 90 / 100);
}

TEST(PoseRefinement, KeepsPrecisionFarFromTheOrigin) {
  SceneOptions scene;
  scene.centre << 60, -40, 3;
  expect_consistent(measure_consistency(scene, {}, 500));
}

TEST(PoseRefinement, SaysSoWhenThereIsTooLittle) {
  std::mt19937 rng(18);
  SceneOptions options;
  for (const int n : {0, 1, 2, 3}) {
    options.num_pairs = n;
    const Scene scene = make_scene(rng, options);
    std::vector<std::uint8_t> mask;
    EXPECT_FALSE(refine_pose(scene.pairs, scene.T_map_camera, 525, {}, &mask).is_converged) << n;
    EXPECT_EQ(mask.size(), static_cast<std::size_t>(n));
  }
  // All pairs the same: a singular problem without depth.
  Correspondences same(50);
  for (int i = 0; i < 50; ++i) same.add(0, 0, 0, 0, 2, 0, 1, 0, i, i);
  const PoseRefinementResult result = refine_pose(same, {}, 525, {}, nullptr);
  if (result.is_converged) { EXPECT_GT(result.covariance.trace(), 1.0); }
  // Not a number must not be taken for a pose.
  Correspondences bad(50);
  for (int i = 0; i < 50; ++i) bad.add(std::nanf(""), 0, std::nanf(""), 0, 2, 0, 1, 0, i, i);
  EXPECT_FALSE(refine_pose(bad, {}, 525, {}, nullptr).is_converged);
}

TEST(PoseRefinement, SameInputGivesTheSameBits) {
  std::mt19937 rng(19);
  SceneOptions options;
  options.outlier_ratio = 0.3;
  const Scene scene = make_scene(rng, options);
  const Rigid3 start = testing::disturbed(rng, scene.T_map_camera, 0.01, 0.01);
  const PoseRefinementResult a = refine_pose(scene.pairs, start, 525, {}, nullptr), b = refine_pose(scene.pairs, start, 525, {}, nullptr);
  EXPECT_EQ(a.T_map_camera.translation, b.T_map_camera.translation);
  EXPECT_EQ(a.T_map_camera.rotation.coeffs(), b.T_map_camera.rotation.coeffs());
  EXPECT_EQ(a.covariance, b.covariance);
}

TEST(PoseRefinement, AllocatesNothing) {
  if (!testing::can_count_allocations()) GTEST_SKIP() << "a sanitizer owns the allocator";
  std::mt19937 rng(20);
  const Scene scene = make_scene(rng, {});
  std::vector<std::uint8_t> mask(scene.pairs.capacity());
  PoseRefinementOptions options;
  const std::uint64_t before = testing::num_allocations();
  const PoseRefinementResult pose_only = refine_pose(scene.pairs, scene.T_map_camera, 525, options, &mask);
  options.estimate_focal_scale = true;
  const PoseRefinementResult with_focal = refine_pose(scene.pairs, scene.T_map_camera, 525, options, &mask);
  EXPECT_EQ(testing::num_allocations(), before);
  EXPECT_TRUE(pose_only.is_converged && with_focal.is_converged);
}

}  // namespace
}  // namespace camloc
