// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Landmarks of one part of the image are moved together, many times; how far poses scatter then is what the covariance must say.
#include "core/registration/shared_errors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/geometry/pose_refinement.h"

namespace camloc {
namespace {

constexpr double kFocalPx = 525;

struct Scene {
  Rigid3 T_map_camera{exp_so3({0.3, -0.5, 0.2}), {1, 2, 3}};
  std::vector<Eigen::Vector3d> p_camera;  ///< landmarks, in the camera
};

/// `columns` of parts of the image from the left hold landmarks.
Scene scene_of(int columns, int per_part) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> within(0.02, 0.28), distance_m(1.5, 3.0);
  Scene scene;
  for (int row = -1; row < 1; ++row) {
    for (int column = -2; column < -2 + columns; ++column) {
      for (int i = 0; i < per_part; ++i) {
        const double z = distance_m(random);
        scene.p_camera.emplace_back((0.3 * column + within(random)) * z, (0.3 * row + within(random)) * z, z);
      }
    }
  }
  return scene;
}

/// Of the scene as it is, measured without noise; each part's landmarks are moved by its `shift` in the map.
Correspondences pairs_of(const Scene& scene, const std::vector<Eigen::Vector3d>& shift, int per_part) {
  Correspondences pairs(scene.p_camera.size());
  for (std::size_t i = 0; i < scene.p_camera.size(); ++i) {
    const Eigen::Vector3d& p = scene.p_camera[i];
    const Eigen::Vector3d q =
        scene.T_map_camera * (p + (shift.empty() ? Eigen::Vector3d(0, 0, 0) : shift[i / static_cast<std::size_t>(per_part)]));
    pairs.add(static_cast<float>(p.x() / p.z()), static_cast<float>(p.y() / p.z()), static_cast<float>(q.x()), static_cast<float>(q.y()),
              static_cast<float>(q.z()), static_cast<float>(p.z()), 1.4F, 0, static_cast<std::int32_t>(i), static_cast<std::int32_t>(i));
  }
  return pairs;
}

Matrix6d promised(const Scene& scene, int per_part, const SharedErrors& errors) {
  const Correspondences pairs = pairs_of(scene, {}, per_part);
  return shared_error_covariance(pairs, std::vector<std::uint8_t>(pairs.size(), 1), scene.T_map_camera, {kFocalPx, {}, true, errors});
}

TEST(SharedErrorsTest, IsHowFarPosesScatterWhenPartsMoveAsOne) {
  constexpr int kPerPart = 15, kTrials = 600;
  constexpr double kSigma_m = 0.003;
  const Scene scene = scene_of(4, kPerPart);
  std::mt19937 random(9);
  std::normal_distribution<double> normal(0, kSigma_m);
  Matrix6d observed = Matrix6d::Zero();
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<Eigen::Vector3d> shift(8);
    for (Eigen::Vector3d& s : shift) s = {normal(random), normal(random), normal(random)};
    const Correspondences pairs = pairs_of(scene, shift, kPerPart);
    std::vector<std::uint8_t> mask(pairs.size());
    const PoseRefinementResult refined = refine_pose(pairs, scene.T_map_camera, kFocalPx, {}, &mask);
    ASSERT_TRUE(refined.is_converged);
    const Vector6d error = pose_error(scene.T_map_camera, refined.T_map_camera);
    observed += error * error.transpose() / kTrials;
  }
  const Matrix6d expected = promised(scene, kPerPart, {kSigma_m, 0});
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(std::sqrt(observed(i, i) / expected(i, i)), 1, 0.15) << i;
}

TEST(SharedErrorsTest, MoreLandmarksOfTheSamePartsDoNotAverageItOut) {
  const double few = promised(scene_of(4, 10), 10, {0.01, 0}).topLeftCorner<3, 3>().trace();
  const double many = promised(scene_of(4, 160), 160, {0.01, 0}).topLeftCorner<3, 3>().trace();
  EXPECT_NEAR(many / few, 1, 0.3);
}

TEST(SharedErrorsTest, ALandmarkSeenInFewPartsIsWorthLess) {
  const double whole = promised(scene_of(4, 20), 20, {0.01, 0}).trace(), narrow = promised(scene_of(1, 80), 80, {0.01, 0}).trace();
  EXPECT_GT(narrow, 2 * whole);
}

TEST(SharedErrorsTest, ATurnOfTheViewsCountsWithTheDistance) {
  const Scene scene = scene_of(4, 20);
  Scene far = scene;
  for (Eigen::Vector3d& p : far.p_camera) p *= 3;
  const SharedErrors turn{0, 0.005};
  const double near_m2 = promised(scene, 20, turn).topLeftCorner<3, 3>().trace();
  const double far_m2 = promised(far, 20, turn).topLeftCorner<3, 3>().trace();
  EXPECT_GT(far_m2, 4 * near_m2);
}

TEST(SharedErrorsTest, NothingIsAddedWithoutThemOrWithoutAPose) {
  const Scene scene = scene_of(4, 20);
  EXPECT_TRUE(promised(scene, 20, {}).isZero(0));
  const Correspondences pairs = pairs_of(scene, {}, 20);
  const SharedErrorsModel model{kFocalPx, {}, true, {0.01, 0.01}};
  const std::vector<std::uint8_t> nobody(pairs.size(), 0);
  EXPECT_TRUE(shared_error_covariance(pairs, nobody, scene.T_map_camera, model).isZero(0));
}

}  // namespace
}  // namespace camloc
