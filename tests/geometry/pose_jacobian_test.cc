// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Derivatives by the pose against differences.
#include "core/geometry/pose_jacobian.h"

#include <gtest/gtest.h>

#include "tests/geometry/generated.h"

namespace camloc {
namespace {

Eigen::Vector3d seen(const Rigid3& T_map_camera, const Eigen::Vector3d& p_map) {
  const Eigen::Vector3d p = T_map_camera.inverse() * p_map;
  return {p.x() / p.z(), p.y() / p.z(), p.z()};
}

TEST(PoseJacobian, AgreesWithDifferences) {
  std::mt19937 rng(1);
  for (int i = 0; i < 100; ++i) {
    const Rigid3 T_map_camera = testing::random_pose(rng, 5);
    Eigen::Vector3d p_camera = testing::random_vector(rng, 1);
    p_camera.z() = 0.5 + std::abs(p_camera.z());
    const Eigen::Vector3d p_map = T_map_camera * p_camera;
    const Eigen::Vector3d at = seen(T_map_camera, p_map);
    const PointJacobian J = point_jacobian(at.x(), at.y(), at.z());
    for (int k = 0; k < 6; ++k) {
      constexpr double kStep = 1e-6;
      const Eigen::Vector3d difference = (seen(moved_in_camera_axes(T_map_camera, kStep * Vector6d::Unit(k)), p_map) -
                                          seen(moved_in_camera_axes(T_map_camera, -kStep * Vector6d::Unit(k)), p_map)) /
                                         (2 * kStep);
      EXPECT_NEAR(J.u[k], difference.x(), 1e-7 * (1 + std::abs(J.u[k])));
      EXPECT_NEAR(J.v[k], difference.y(), 1e-7 * (1 + std::abs(J.v[k])));
      EXPECT_NEAR(J.z[k], difference.z(), 1e-7 * (1 + std::abs(J.z[k])));
    }
  }
}

TEST(PoseJacobian, ChangeInCameraAxesTurnedIsThePoseError) {
  std::mt19937 rng(2);
  const Rigid3 estimate = testing::random_pose(rng, 5);
  Vector6d change;
  change << 0.01, -0.02, 0.03, 0.004, 0.005, -0.006;
  const Vector6d error = pose_error(moved_in_camera_axes(estimate, change), estimate);
  EXPECT_LT((error.head<3>() - estimate.rotation * change.head<3>()).norm(), 1e-13);
  EXPECT_LT((error.tail<3>() - estimate.rotation * change.tail<3>()).norm(), 1e-13);
}

}  // namespace
}  // namespace camloc
