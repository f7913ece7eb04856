// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Generated truth, what the points leave open, and Monte Carlo of the covariance.
#include "core/geometry/alignment.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "core/geometry/symmetric_system.h"
#include "tests/geometry/generated.h"

namespace camloc {
namespace {

using testing::random_pose;
using testing::random_vector;

std::vector<PointPair> make_pairs(std::mt19937& rng, const Rigid3& T_a_b, int count, double spread_m, double scale = 1) {
  std::vector<PointPair> pairs;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d p_b = random_vector(rng, spread_m);
    pairs.push_back({scale * (T_a_b.rotation * p_b) + T_a_b.translation, p_b, 0.01 * (1 + i % 4)});
  }
  return pairs;
}

void expect_same(const Rigid3& a, const Rigid3& b, double tolerance) {
  EXPECT_LT((a.translation - b.translation).norm(), tolerance);
  EXPECT_LT(rotation_distance_rad(a.rotation, b.rotation), tolerance);
}

TEST(Alignment, FindsTheMotionExactly) {
  std::mt19937 rng(1);
  for (int count = 3; count < 20; ++count) {
    const Rigid3 T_a_b = random_pose(rng, 10);
    const Alignment rigid = align_rigid(make_pairs(rng, T_a_b, count, 5));
    EXPECT_EQ(rigid.rank, AlignmentRank::kFull);
    EXPECT_EQ(rigid.degrees_of_freedom, 3 * count - 6);
    expect_same(rigid.T_a_b, T_a_b, 1e-9);
    EXPECT_LT(rigid.rms_m, 1e-9);
    EXPECT_EQ(rigid.scale, 1);
    const Alignment similar = align_similarity(make_pairs(rng, T_a_b, count, 5, 1.7));
    expect_same(similar.T_a_b, T_a_b, 1e-9);
    EXPECT_NEAR(similar.scale, 1.7, 1e-9);
    EXPECT_EQ(similar.degrees_of_freedom, 3 * count - 7);
  }
}

TEST(Alignment, AgreesWithEigenOnNoisyPoints) {
  std::mt19937 rng(2);
  std::vector<PointPair> pairs = make_pairs(rng, random_pose(rng, 3), 12, 2);
  Eigen::Matrix3Xd a(3, 12), b(3, 12);
  for (int i = 0; i < 12; ++i) {
    pairs[i].sigma_m = 0.3;
    pairs[i].p_a += random_vector(rng, 0.3);
    a.col(i) = pairs[i].p_a;
    b.col(i) = pairs[i].p_b;
  }
  EXPECT_LT((align_rigid(pairs).T_a_b.matrix() - Eigen::umeyama(b, a, false)).cwiseAbs().maxCoeff(), 1e-9);
  Eigen::Matrix4d similar = align_similarity(pairs).T_a_b.matrix();
  similar.topLeftCorner<3, 3>() *= align_similarity(pairs).scale;
  EXPECT_LT((similar - Eigen::umeyama(b, a, true)).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(Alignment, NoSmallMotionIsBetter) {
  std::mt19937 rng(3);
  std::vector<PointPair> pairs = make_pairs(rng, random_pose(rng, 3), 7, 2);
  for (PointPair& pair : pairs) pair.p_a += random_vector(rng, pair.sigma_m);
  const Alignment best = align_rigid(pairs);
  for (int axis = 0; axis < 6; ++axis) {
    for (const double step : {-1e-3, 1e-3}) {
      Vector6d change = Vector6d::Zero();
      change[axis] = step;
      const Rigid3 T{exp_so3(change.tail<3>()) * best.T_a_b.rotation, best.T_a_b.translation + change.head<3>()};
      double chi_squared = 0;
      for (const PointPair& pair : pairs) chi_squared += (pair.p_a - T * pair.p_b).squaredNorm() / (pair.sigma_m * pair.sigma_m);
      EXPECT_GT(chi_squared, best.chi_squared);
    }
  }
}

TEST(Alignment, AMirrorImageDoesNotBecomeAMotion) {
  std::mt19937 rng(4);
  std::vector<PointPair> pairs = make_pairs(rng, random_pose(rng, 3), 8, 2);
  for (PointPair& pair : pairs) pair.p_a.x() = -pair.p_a.x();
  const Alignment alignment = align_rigid(pairs);
  EXPECT_NEAR(alignment.T_a_b.rotation.toRotationMatrix().determinant(), 1, 1e-9);
  EXPECT_GT(alignment.rms_m, 0.5);
}

TEST(Alignment, PointsInAPlaneAreEnough) {
  std::mt19937 rng(5);
  const Rigid3 T_a_b = random_pose(rng, 3);
  std::vector<PointPair> pairs = make_pairs(rng, T_a_b, 6, 2);
  for (PointPair& pair : pairs) {
    pair.p_b.z() = 1;
    pair.p_a = T_a_b * pair.p_b;
  }
  EXPECT_EQ(align_rigid(pairs).rank, AlignmentRank::kFull);
  expect_same(align_rigid(pairs).T_a_b, T_a_b, 1e-9);
}

TEST(Alignment, CoordinatesOfANationalGridLoseNothing) {
  std::mt19937 rng(6);
  Rigid3 T_a_b = random_pose(rng, 3);
  T_a_b.translation += Eigen::Vector3d(456789.123, 5432109.876, 345.6);
  const Alignment alignment = align_rigid(make_pairs(rng, T_a_b, 8, 10));
  EXPECT_LT((alignment.T_a_b.translation - T_a_b.translation).norm(), 1e-7);
  EXPECT_LT(rotation_distance_rad(alignment.T_a_b.rotation, T_a_b.rotation), 1e-9);
  // And from there: the lever arm is 5000 km long, so that a point is told from another only by the whole transform.
  std::vector<PointPair> swapped = make_pairs(rng, T_a_b, 8, 10);
  for (PointPair& pair : swapped) std::swap(pair.p_a, pair.p_b);
  const Alignment back = align_rigid(swapped);
  for (const PointPair& pair : swapped) EXPECT_LT((back.map(pair.p_b) - pair.p_a).norm(), 1e-7);
}

TEST(Alignment, SaysWhatFewPointsLeaveOpen) {
  std::mt19937 rng(7);
  const Rigid3 T_a_b = random_pose(rng, 3);
  EXPECT_EQ(align_rigid({}).rank, AlignmentRank::kNothing);
  EXPECT_GT(align_rigid({}).covariance(0, 0), 1e9);

  const std::vector<PointPair> one = make_pairs(rng, T_a_b, 1, 2);
  EXPECT_EQ(align_rigid(one).rank, AlignmentRank::kPosition);
  EXPECT_LT((align_similarity(one).map(one[0].p_b) - one[0].p_a).norm(), 1e-12);
  EXPECT_EQ(align_similarity(one).scale, 1);
  const std::vector<PointPair> thrice(3, one[0]);
  EXPECT_EQ(align_rigid(thrice).rank, AlignmentRank::kPosition);
  EXPECT_NEAR(align_rigid(thrice).covariance(5, 5), std::numbers::pi * std::numbers::pi, 1e-9);

  const std::vector<PointPair> two = make_pairs(rng, T_a_b, 2, 2);
  const Alignment line = align_rigid(two);
  EXPECT_EQ(line.rank, AlignmentRank::kLine);
  EXPECT_NEAR(std::abs(line.free_axis.dot((two[1].p_a - two[0].p_a).normalized())), 1, 1e-9);
  EXPECT_LT(line.rms_m, 1e-9);
}

TEST(Alignment, PointsOnALineLeaveTheTurnAboutItOpen) {
  std::mt19937 rng(8);
  const Rigid3 T_a_b = random_pose(rng, 3);
  std::vector<PointPair> pairs;
  const Eigen::Vector3d direction_b = random_vector(rng, 1).normalized();
  for (int i = 0; i < 6; ++i) {
    const Eigen::Vector3d p_b = Eigen::Vector3d(1, 2, 3) + i * direction_b;
    pairs.push_back({T_a_b * p_b, p_b, 0.01});
  }
  const Alignment line = align_rigid(pairs);
  ASSERT_EQ(line.rank, AlignmentRank::kLine);
  EXPECT_NEAR(std::abs(line.free_axis.dot(T_a_b.rotation * direction_b)), 1, 1e-9);
  EXPECT_LT(line.rms_m, 1e-9);
  const Eigen::Matrix3d turn = line.covariance.bottomRightCorner<3, 3>();
  EXPECT_NEAR(line.free_axis.dot(turn * line.free_axis), std::numbers::pi * std::numbers::pi, 1e-6);
  EXPECT_LT(turn.trace(), std::numbers::pi * std::numbers::pi + 1e-3);
  for (const LeaveOneOutResidual& residual : leave_one_out(pairs)) EXPECT_FALSE(residual.is_determined);
}

/// Mean of the squared normalized error over many noisy copies.
struct MonteCarlo {
  double nees = 0, chi_squared_per_freedom = 0, loo_squared = 0;
};

MonteCarlo monte_carlo(int count, bool is_planar) {
  std::mt19937 rng(9);
  const Rigid3 T_a_b = random_pose(rng, 20);
  std::vector<PointPair> pairs = make_pairs(rng, T_a_b, count, 4);
  for (int i = 0; i < count; ++i) {
    // Around a room whose corner is a long lever away from the origin.
    const double angle = 2 * std::numbers::pi * i / count;
    pairs[i].p_b = Eigen::Vector3d(30 + 4 * std::cos(angle), -20 + 4 * std::sin(angle), is_planar ? 0 : i % 2 * 2.5);
    pairs[i].p_a = T_a_b * pairs[i].p_b;
  }
  MonteCarlo mean;
  constexpr int kTrials = 4000;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<PointPair> noisy = pairs;
    for (PointPair& pair : noisy) pair.p_a += random_vector(rng, pair.sigma_m);
    const Alignment alignment = align_rigid(noisy);
    const Vector6d error = pose_error(T_a_b, alignment.T_a_b);
    mean.nees += squared_mahalanobis(error, alignment.covariance) / kTrials;
    mean.chi_squared_per_freedom += alignment.chi_squared / alignment.degrees_of_freedom / kTrials;
    const double sigmas = leave_one_out(noisy)[0].sigmas();
    mean.loo_squared += sigmas * sigmas / kTrials;
  }
  return mean;
}

TEST(Alignment, CovarianceIsHonest) {
  for (const bool is_planar : {false, true}) {
    for (const int count : {4, 6, 15}) {
      const MonteCarlo mean = monte_carlo(count, is_planar);
      EXPECT_NEAR(mean.nees, 6, 0.35) << count;  // standard deviation of the mean: sqrt(12 / 4000) = 0.055
      EXPECT_NEAR(mean.chi_squared_per_freedom, 1, 0.05) << count;
      EXPECT_NEAR(mean.loo_squared, 3, 0.3) << count;
    }
  }
}

TEST(Alignment, ScaleSigmaIsHonest) {
  std::mt19937 rng(10);
  const Rigid3 T_a_b = random_pose(rng, 3);
  const std::vector<PointPair> pairs = make_pairs(rng, T_a_b, 6, 3);
  double squared = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    std::vector<PointPair> noisy = pairs;
    for (PointPair& pair : noisy) pair.p_a += random_vector(rng, pair.sigma_m);
    const Alignment alignment = align_similarity(noisy);
    squared += std::pow((alignment.scale - 1) / alignment.scale_sigma, 2) / 2000;
  }
  EXPECT_NEAR(squared, 1, 0.15);
}

TEST(Alignment, LeaveOneOutFindsTheWrongPoint) {
  std::mt19937 rng(11);
  std::vector<PointPair> pairs = make_pairs(rng, random_pose(rng, 3), 7, 4);
  for (PointPair& pair : pairs) pair.p_a += random_vector(rng, pair.sigma_m);
  pairs[4].p_a.y() += 1;
  const std::vector<LeaveOneOutResidual> residuals = leave_one_out(pairs);
  ASSERT_EQ(residuals.size(), 7U);
  EXPECT_NEAR(residuals[4].error_m.y(), 1, 0.15);
  EXPECT_GT(residuals[4].sigmas(), 10);
  for (std::size_t i = 0; i < 7; ++i) EXPECT_LE(residuals[i].sigmas(), residuals[4].sigmas());
}

}  // namespace
}  // namespace camloc
