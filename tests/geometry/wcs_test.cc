// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// World datum: first-order covariance against a Monte Carlo of the same errors.
#include "core/geometry/wcs.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "tests/geometry/generated.h"

namespace camloc {
namespace {

Matrix6d random_covariance(std::mt19937& rng, double position_sigma_m, double rotation_sigma_rad) {
  Matrix6d root;
  for (int column = 0; column < 6; ++column) root.col(column) << testing::random_vector(rng, 1), testing::random_vector(rng, 1);
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(position_sigma_m), Eigen::Vector3d::Constant(rotation_sigma_rad);
  root = sigma.asDiagonal() * root;
  return root * root.transpose() / 6.0;
}

Rigid3 moved(const Rigid3& T, const Vector6d& error) { return {exp_so3(error.tail<3>()) * T.rotation, T.translation + error.head<3>()}; }

Vector6d sample(std::mt19937& rng, const Matrix6d& root) {
  Vector6d v;
  v << testing::random_vector(rng, 1), testing::random_vector(rng, 1);
  return root * v;
}

TEST(Wcs, PoseIsTheProduct) {
  std::mt19937 rng(1);
  const WcsDatum datum{testing::random_pose(rng, 50), Matrix6d::Zero()};
  const PoseWithCovariance pose{testing::random_pose(rng, 10), Matrix6d::Zero()};
  const PoseWithCovariance in_wcs = to_wcs(datum, pose);
  EXPECT_LT((in_wcs.pose.matrix() - datum.T_wcs_map.matrix() * pose.pose.matrix()).norm(), 1e-12);
  EXPECT_EQ(in_wcs.covariance.norm(), 0.0);
}

TEST(Wcs, CovarianceMatchesMonteCarlo) {
  std::mt19937 rng(2);
  const WcsDatum datum{testing::random_pose(rng, 50), random_covariance(rng, 0.02, 0.002)};
  const PoseWithCovariance pose{testing::random_pose(rng, 15), random_covariance(rng, 0.02, 0.01)};
  const PoseWithCovariance in_wcs = to_wcs(datum, pose);
  const Matrix6d datum_root = datum.covariance.llt().matrixL(), pose_root = pose.covariance.llt().matrixL();
  Matrix6d measured = Matrix6d::Zero();
  constexpr int kSamples = 40000;
  for (int i = 0; i < kSamples; ++i) {
    const Rigid3 truth = moved(datum.T_wcs_map, sample(rng, datum_root)) * moved(pose.pose, sample(rng, pose_root));
    const Vector6d error = pose_error(truth, in_wcs.pose);
    measured += error * error.transpose() / kSamples;
  }
  // Relative to the predicted covariance, in its own whitened axes: all eigenvalues near one.
  const Matrix6d root = in_wcs.covariance.llt().matrixL();
  const Matrix6d whitened = root.inverse() * measured * root.inverse().transpose();
  EXPECT_LT((whitened - Matrix6d::Identity()).cwiseAbs().maxCoeff(), 0.05) << whitened;
}

TEST(Wcs, LeverArmOfTheDatumIsTheCameraPosition) {
  WcsDatum datum;
  datum.covariance(5, 5) = 1e-6;  // 1 mrad about the vertical
  PoseWithCovariance pose;
  pose.pose.translation << 60, 0, 0;
  const Matrix6d covariance = to_wcs(datum, pose).covariance;
  EXPECT_NEAR(std::sqrt(covariance(1, 1)), 0.06, 1e-9);
  EXPECT_NEAR(covariance(0, 0), 0.0, 1e-15);
}

}  // namespace
}  // namespace camloc
