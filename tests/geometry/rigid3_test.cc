// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Rigid transforms against matrices and against the definition T_a_b.
#include "core/geometry/rigid3.h"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/geometry/generated.h"

namespace camloc {
namespace {

TEST(Rigid3, ComposesAndInvertsLikeMatrices) {
  std::mt19937 rng(1);
  for (int i = 0; i < 200; ++i) {
    const Rigid3 T_a_b = testing::random_pose(rng, 10), T_b_c = testing::random_pose(rng, 10);
    EXPECT_LT(((T_a_b * T_b_c).matrix() - T_a_b.matrix() * T_b_c.matrix()).norm(), 1e-12);
    EXPECT_LT((T_a_b.inverse().matrix() - T_a_b.matrix().inverse()).norm(), 1e-11);
    const Eigen::Vector3d p = testing::random_vector(rng, 5);
    EXPECT_LT(((T_a_b * T_b_c) * p - T_a_b * (T_b_c * p)).norm(), 1e-12);
  }
}

TEST(Rigid3, ExponentialAndLogarithmAreInverse) {
  std::mt19937 rng(2);
  for (const double angle : {0.0, 1e-12, 1e-9, 1e-7, 9.9e-5, 1.01e-4, 1e-3, 0.5, 3.0, std::numbers::pi - 1e-7}) {
    const Eigen::Vector3d v = angle * testing::random_vector(rng, 1).normalized();
    const Eigen::Quaterniond q = exp_so3(v);
    EXPECT_NEAR(q.norm(), 1.0, 1e-15);
    EXPECT_LT((log_so3(q) - v).norm(), 1e-14 + 1e-13 * angle) << angle;
    EXPECT_LT((log_so3(Eigen::Quaterniond(-q.coeffs())) - v).norm(), 1e-14 + 1e-13 * angle) << "-q is the same rotation";
    if (angle > 0) {
      const Eigen::Quaterniond expected(Eigen::AngleAxisd(angle, v.normalized()));
      EXPECT_LT((q.coeffs() - expected.coeffs()).norm(), 1e-15);
    }
  }
}

TEST(Rigid3, LogarithmOfHalfATurnIsFinite) {
  const Eigen::Vector3d v = log_so3(Eigen::Quaterniond(0, 0, 1, 0));
  EXPECT_NEAR(v.norm(), std::numbers::pi, 1e-15);
}

TEST(Rigid3, NearestRotationUndoesSmallDeformation) {
  std::mt19937 rng(3);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Quaterniond truth = testing::random_pose(rng, 1).rotation;
    Eigen::Matrix3d deformed = truth.toRotationMatrix();
    for (int column = 0; column < 3; ++column) deformed.col(column) += testing::random_vector(rng, 4e-4);
    const Eigen::Quaterniond nearest = nearest_rotation(deformed);
    EXPECT_LT(rotation_distance_rad(nearest, truth), 2e-3);
    // Closest in the Frobenius sense: any small turn away from it is farther.
    const double distance = (nearest.toRotationMatrix() - deformed).norm();
    for (int axis = 0; axis < 3; ++axis) {
      for (const double turn : {-1e-4, 1e-4}) {
        const Eigen::Quaterniond other = exp_so3(turn * Eigen::Vector3d::Unit(axis)) * nearest;
        EXPECT_GT((other.toRotationMatrix() - deformed).norm(), distance);
      }
    }
  }
  EXPECT_NEAR(nearest_rotation(-Eigen::Matrix3d::Identity()).toRotationMatrix().determinant(), 1.0, 1e-12);
}

TEST(Rigid3, ShortestTurnTurnsOneDirectionOntoTheOther) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), tilted = Eigen::Vector3d(0.6, 0, 0.8),
                        almost_back = Eigen::Vector3d(-1, 1e-5, 0).normalized();
  for (const Eigen::Vector3d& to : {x, tilted, almost_back, Eigen::Vector3d(-x)}) {
    const Eigen::Quaterniond turn = shortest_turn(x, to);
    EXPECT_NEAR(turn.norm(), 1, 1e-12);
    EXPECT_LT((turn * x - to).norm(), 1e-9) << to.transpose();
    EXPECT_NEAR(rotation_distance_rad(turn, Eigen::Quaterniond::Identity()), std::acos(x.dot(to)), 1e-7) << to.transpose();
  }
}

TEST(Rigid3, RotationDistanceIsTheAngle) {
  std::mt19937 rng(4);
  const Eigen::Quaterniond a = testing::random_pose(rng, 1).rotation;
  const Eigen::Quaterniond b = exp_so3({0, 0.3, 0}) * a;
  EXPECT_NEAR(rotation_distance_rad(a, b), 0.3, 1e-14);
  EXPECT_NEAR(rotation_distance_rad(a, Eigen::Quaterniond(-b.coeffs())), 0.3, 1e-14);
  EXPECT_EQ(rotation_distance_rad(a, a), 0.0);
}

TEST(Rigid3, PoseErrorLeadsFromEstimateToTruth) {
  std::mt19937 rng(5);
  const Rigid3 truth = testing::random_pose(rng, 3), estimate = testing::disturbed(rng, truth, 0.1, 0.1);
  const Vector6d error = pose_error(truth, estimate);
  EXPECT_LT((estimate.translation + error.head<3>() - truth.translation).norm(), 1e-14);
  EXPECT_LT(rotation_distance_rad(exp_so3(error.tail<3>()) * estimate.rotation, truth.rotation), 1e-12);
}

TEST(Rigid3, InterpolatesFromEndToEnd) {
  std::mt19937 rng(6);
  const Rigid3 from = testing::random_pose(rng, 3), to = testing::random_pose(rng, 3);
  EXPECT_LT(pose_error(from, interpolate(from, to, 0)).norm(), 1e-12);
  EXPECT_LT(pose_error(to, interpolate(from, to, 1)).norm(), 1e-12);
  const double whole = rotation_distance_rad(from.rotation, to.rotation);
  EXPECT_NEAR(rotation_distance_rad(from.rotation, interpolate(from, to, 0.25).rotation), 0.25 * whole, 1e-12);
}

}  // namespace
}  // namespace camloc
