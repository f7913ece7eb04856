// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The robust estimator: success by outlier ratio against OpenCV, determinism, bad input, no allocation.
#include "core/geometry/pnp_ransac.h"

#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>

#include "tests/geometry/allocation_counter.h"
#include "tests/geometry/generated.h"

namespace camloc {
namespace {

using testing::make_scene;
using testing::Scene;
using testing::SceneOptions;

bool is_near(const Rigid3& truth, const Rigid3& estimate) {
  const Vector6d error = pose_error(truth, estimate);
  return error.head<3>().norm() < 0.05 && error.tail<3>().norm() < 0.035;
}

struct Score {
  int num_near = 0;
  std::vector<double> position_errors_m;
  [[nodiscard]] double median_m() {
    std::nth_element(position_errors_m.begin(), position_errors_m.begin() + position_errors_m.size() / 2, position_errors_m.end());
    return position_errors_m[position_errors_m.size() / 2];
  }
  void add(const Rigid3& truth, const Rigid3& estimate) {
    num_near += is_near(truth, estimate) ? 1 : 0;
    position_errors_m.push_back((truth.translation - estimate.translation).norm());
  }
};

Rigid3 opencv_pose(const Correspondences& pairs, int iterations) {
  std::vector<cv::Point3f> points;
  std::vector<cv::Point2f> pixels;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    points.emplace_back(pairs.X[k], pairs.Y[k], pairs.Z[k]);
    pixels.emplace_back(pairs.x[k] * 525, pairs.y[k] * 525);
  }
  cv::Vec3d r, t;
  const cv::Matx33d K(525, 0, 0, 0, 525, 0, 0, 0, 1);
  cv::theRNG().state = 42;
  const bool is_found =
      cv::solvePnPRansac(points, pixels, K, cv::noArray(), r, t, false, iterations, 5.0F, 0.99, cv::noArray(), cv::SOLVEPNP_P3P);
  return is_found ? Rigid3{exp_so3({r[0], r[1], r[2]}), {t[0], t[1], t[2]}}.inverse() : Rigid3{{}, Eigen::Vector3d::Constant(1e3)};
}

void compare_with_opencv(double outlier_ratio, int num_scenes, double min_share) {
  std::mt19937 rng(21);
  SceneOptions options;
  options.outlier_ratio = outlier_ratio;
  PnpRansacOptions ransac_options;
  ransac_options.max_relative_depth_error = 0;  // OpenCV knows no depth either
  PnpRansac ransac(ransac_options);
  Score ours, theirs;
  for (int i = 0; i < num_scenes; ++i) {
    const Scene scene = make_scene(rng, options);
    const PnpRansacResult result = ransac.estimate(scene.pairs, 525, static_cast<std::uint64_t>(i));
    EXPECT_TRUE(result.is_found);
    ours.add(scene.T_map_camera, result.T_map_camera);
    theirs.add(scene.T_map_camera, opencv_pose(scene.pairs, 600));
  }
  EXPECT_GE(ours.num_near, num_scenes * min_share);
  EXPECT_GE(ours.num_near, theirs.num_near - num_scenes / 100);
  EXPECT_LT(ours.median_m(), 1.05 * theirs.median_m());
}

TEST(PnpRansac, NoOutliers) { compare_with_opencv(0.0, 60, 1.0); }
TEST(PnpRansac, FortyPercentOutliers) { compare_with_opencv(0.4, 60, 1.0); }
TEST(PnpRansac, SixtyPercentOutliers) { compare_with_opencv(0.6, 60, 1.0); }
// 600 samples at 20 % inliers hold an all-inlier triple with probability 1 - (1 - 0.008)^600 = 99 %.
TEST(PnpRansac, EightyPercentOutliers) { compare_with_opencv(0.8, 60, 0.95); }

TEST(PnpRansac, DepthAndRankHelpWhereUniformSamplingFails) {
  // At 10 % inliers uniform sampling of 600 triples succeeds 45 % of the time by arithmetic.
  std::mt19937 rng(22);
  SceneOptions options;
  options.outlier_ratio = 0.9;
  PnpRansacOptions blind_options;
  blind_options.max_relative_depth_error = 0;
  PnpRansac with_depth{PnpRansacOptions{}}, blind(blind_options);
  Score depth_score, rank_score;
  constexpr int kScenes = 60;
  for (int i = 0; i < kScenes; ++i) {
    options.is_rank_informative = false;
    const Scene scene = make_scene(rng, options);
    depth_score.add(scene.T_map_camera, with_depth.estimate(scene.pairs, 525, 7).T_map_camera);
    options.is_rank_informative = true;
    const Scene ranked = make_scene(rng, options);
    rank_score.add(ranked.T_map_camera, blind.estimate(ranked.pairs, 525, 7).T_map_camera);
  }
  EXPECT_GE(depth_score.num_near, kScenes * 80 / 100);
  EXPECT_GE(rank_score.num_near, kScenes * 70 / 100);
}

TEST(PnpRansac, DepthMismatchMakesAnOutlier) {
  std::mt19937 rng(23);
  SceneOptions options;
  Scene scene = make_scene(rng, options);
  for (std::size_t i = 0; i < 50; ++i) scene.pairs.depth_m[i] *= 1.5F;
  PnpRansac ransac{PnpRansacOptions{}};
  const PnpRansacResult result = ransac.estimate(scene.pairs, 525, 1);
  ASSERT_TRUE(result.is_found);
  ASSERT_EQ(ransac.inlier_mask().size(), scene.pairs.size());
  for (std::size_t i = 0; i < 50; ++i) EXPECT_EQ(ransac.inlier_mask()[i], 0);
  EXPECT_GE(result.num_inliers, 140);
}

TEST(PnpRansac, MaskCountAndCostBelongTogether) {
  std::mt19937 rng(24);
  SceneOptions options;
  options.outlier_ratio = 0.5;
  const Scene scene = make_scene(rng, options);
  PnpRansac ransac{PnpRansacOptions{}};
  const PnpRansacResult result = ransac.estimate(scene.pairs, 525, 1);
  ASSERT_TRUE(result.is_found);
  int num_marked = 0, num_wrong = 0;
  for (std::size_t i = 0; i < scene.pairs.size(); ++i) {
    num_marked += ransac.inlier_mask()[i];
    num_wrong += ransac.inlier_mask()[i] != scene.is_inlier[static_cast<std::size_t>(scene.pairs.landmark[i])] ? 1 : 0;
  }
  EXPECT_EQ(num_marked, result.num_inliers);
  EXPECT_LE(num_wrong, 8);
  const double outlier_cost = 25.0 * static_cast<double>(scene.pairs.size() - result.num_inliers);
  EXPECT_GE(result.cost, outlier_cost);
  EXPECT_LE(result.cost, outlier_cost + 4.0 * result.num_inliers);
}

TEST(PnpRansac, KeepsPrecisionFarFromTheOrigin) {
  std::mt19937 rng(25);
  SceneOptions options;
  options.outlier_ratio = 0.5;
  PnpRansac ransac{PnpRansacOptions{}};
  options.centre << 60, -40, 3;
  Score far;
  for (int i = 0; i < 40; ++i) {
    const Scene scene = make_scene(rng, options);
    far.add(scene.T_map_camera, ransac.estimate(scene.pairs, 525, 3).T_map_camera);
  }
  EXPECT_EQ(far.num_near, 40);
  EXPECT_LT(far.median_m(), 0.005);
}

TEST(PnpRansac, SameSeedGivesTheSameBits) {
  std::mt19937 rng(26);
  SceneOptions options;
  options.outlier_ratio = 0.85;
  const Scene scene = make_scene(rng, options);
  PnpRansac a{PnpRansacOptions{}}, b{PnpRansacOptions{}};
  const Scene other = make_scene(rng, options);
  (void)b.estimate(other.pairs, 525, 99);  // what came before must not matter
  const PnpRansacResult first = a.estimate(scene.pairs, 525, 5), second = b.estimate(scene.pairs, 525, 5);
  EXPECT_EQ(first.T_map_camera.translation, second.T_map_camera.translation);
  EXPECT_EQ(first.T_map_camera.rotation.coeffs(), second.T_map_camera.rotation.coeffs());
  EXPECT_EQ(first.cost, second.cost);
  EXPECT_EQ(a.inlier_mask(), b.inlier_mask());
}

TEST(PnpRansac, BadInputIsNotFound) {
  PnpRansac ransac{PnpRansacOptions{}};
  std::mt19937 rng(27);
  SceneOptions options;
  for (const int n : {0, 1, 2, 3}) {
    options.num_pairs = n;
    EXPECT_FALSE(ransac.estimate(make_scene(rng, options).pairs, 525, 1).is_found);
    EXPECT_EQ(ransac.inlier_mask().size(), static_cast<std::size_t>(n < 4 ? n : 0));
  }
  Correspondences same(100), bad(100);
  for (int i = 0; i < 100; ++i) {
    same.add(0.1F, 0.1F, 1, 2, 3, 0, 1, 0, i, i);
    bad.add(std::nanf(""), 0, std::nanf(""), 0, 2, 0, 1, 0, i, i);
  }
  EXPECT_FALSE(ransac.estimate(same, 525, 1).is_found);
  EXPECT_FALSE(ransac.estimate(bad, 525, 1).is_found);
}

TEST(PnpRansac, UsesTheBestPairsWhenThereAreTooMany) {
  PnpRansacOptions options;
  options.max_pairs = 100;
  PnpRansac ransac(options);
  std::mt19937 rng(28);
  const Scene scene = make_scene(rng, {});
  const PnpRansacResult result = ransac.estimate(scene.pairs, 525, 1);
  EXPECT_TRUE(result.is_found);
  EXPECT_LE(result.num_inliers, 100);
  EXPECT_EQ(ransac.inlier_mask().size(), 100U);
}

TEST(PnpRansac, AllocatesNothing) {
  if (!testing::can_count_allocations()) GTEST_SKIP() << "a sanitizer owns the allocator";
  std::mt19937 rng(29);
  SceneOptions options;
  options.outlier_ratio = 0.7;
  const Scene scene = make_scene(rng, options);
  PnpRansac ransac{PnpRansacOptions{}};
  const std::uint64_t before = testing::num_allocations();
  const PnpRansacResult result = ransac.estimate(scene.pairs, 525, 1);
  EXPECT_EQ(testing::num_allocations(), before);
  EXPECT_TRUE(result.is_found);
}

}  // namespace
}  // namespace camloc
