// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Statistics of errors that were made on purpose.
#include "tools/evaluation/trajectory_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace camloc::tools {
namespace {

Rigid3 truth_at(std::int64_t stamp_ns) {
  const double s = 1e-9 * static_cast<double>(stamp_ns);
  return {Eigen::Quaterniond(Eigen::AngleAxisd(0.1 * s, Eigen::Vector3d::UnitZ())), {std::cos(s), std::sin(s), 0.1 * s}};
}
std::optional<Rigid3> reference(std::int64_t stamp_ns) { return truth_at(stamp_ns); }

/// Frame i is off by that many metres along x.
EstimatedTrajectory off_by(const std::vector<double>& errors_m) {
  EstimatedTrajectory estimate;
  for (std::size_t i = 0; i < errors_m.size(); ++i) {
    EstimatedPose pose;
    pose.stamp_ns = static_cast<std::int64_t>(i) * 100'000'000;
    pose.T_map_camera = truth_at(pose.stamp_ns);
    pose.T_map_camera.translation.x() += errors_m[i];
    estimate.poses.push_back(pose);
  }
  return estimate;
}

TEST(TrajectoryErrorTest, StatisticsAndSharesOfAllFrames) {
  const TrajectoryErrors e = compare(off_by({0.01, 0.03, 0.07, 0.2, 0.5}), reference, 10);
  EXPECT_EQ(e.num_frames, 10U);
  EXPECT_EQ(e.num_localized, 5U);
  EXPECT_EQ(e.num_compared, 5U);
  EXPECT_NEAR(e.translation_m.median, 0.07, 1e-9);
  EXPECT_NEAR(e.translation_m.mean, 0.162, 1e-9);
  EXPECT_NEAR(e.translation_m.p90, 0.38, 1e-9);
  EXPECT_NEAR(e.translation_m.max, 0.5, 1e-9);
  EXPECT_NEAR(e.rotation_deg.max, 0, 1e-5);
  const std::array<double, 4> shares{0.1, 0.2, 0.3, 0.4};
  for (std::size_t i = 0; i < shares.size(); ++i) EXPECT_NEAR(e.share_within[i], shares[i], 1e-9);
  EXPECT_EQ(e.num_misleading, 1U);
  EXPECT_EQ(e.num_with_covariance, 0U);
}

TEST(TrajectoryErrorTest, ATurnAloneMisleads) {
  EstimatedTrajectory estimate = off_by({0, 0});
  estimate.poses[0].T_map_camera.rotation *= Eigen::Quaterniond(Eigen::AngleAxisd(11 * std::numbers::pi / 180, Eigen::Vector3d::UnitY()));
  const TrajectoryErrors e = compare(estimate, reference, 2);
  EXPECT_NEAR(e.rotation_deg.max, 11, 1e-6);
  EXPECT_EQ(e.num_misleading, 1U);
  EXPECT_NEAR(e.share_within[3], 0.5, 1e-9);
}

TEST(TrajectoryErrorTest, AlignmentTakesOutARigidMotion) {
  EstimatedTrajectory estimate = off_by(std::vector<double>(20, 0.0));
  const Rigid3 T_moved_reference{Eigen::Quaterniond(Eigen::AngleAxisd(1.0, Eigen::Vector3d(1, 2, 3).normalized())), {5, -3, 2}};
  for (EstimatedPose& pose : estimate.poses) pose.T_map_camera = T_moved_reference * pose.T_map_camera;
  EXPECT_EQ(compare(estimate, reference, 20).num_misleading, 20U);
  const TrajectoryErrors e = compare(estimate, reference, 20, align_by_positions(estimate, reference));
  EXPECT_LT(e.translation_m.max, 1e-6);
  EXPECT_LT(e.rotation_deg.max, 1e-4);
  EXPECT_LT((e.T_reference_estimate->translation - T_moved_reference.inverse().translation).norm(), 1e-6);
}

TEST(TrajectoryErrorTest, HonestCovariancesGiveHonestNees) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  Matrix6d covariance = Matrix6d::Zero();
  covariance.diagonal() << 1e-4, 4e-4, 9e-4, 1e-4, 1e-4, 4e-4;
  EstimatedTrajectory estimate = off_by(std::vector<double>(2000, 0.0));
  double expected_sum = 0;
  for (EstimatedPose& pose : estimate.poses) {
    for (int i = 0; i < 3; ++i) pose.T_map_camera.translation[i] += normal(random) * std::sqrt(covariance(3 + i, 3 + i));
    pose.covariance = covariance;
    const Vector6d error = pose_error(truth_at(pose.stamp_ns), pose.T_map_camera);
    expected_sum += (error.array().square() / covariance.diagonal().array()).sum();
  }
  const TrajectoryErrors e = compare(estimate, reference, 2000);
  EXPECT_EQ(e.num_with_covariance, 2000U);
  EXPECT_NEAR(e.nees_mean, expected_sum / 2000, 1e-6);
  EXPECT_GT(e.share_inside_95, 0.95);  // only half of the six directions were disturbed
}

// 3, 4 and 12 units: the mean square is 169 / 3.
TEST(TrajectoryErrorTest, TheRootMeanSquareIsWhatItSays) {
  EXPECT_NEAR(compare(off_by({0.03, 0.04, 0.12}), reference, 3).translation_m.rmse, 0.13 / std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(compare(off_by({0.5}), reference, 1).translation_m.rmse, 0.5, 1e-12);
  EstimatedTrajectory turned = off_by({0, 0});
  for (const double deg : {6.0, 8.0})
    turned.poses[deg == 6 ? 0 : 1].T_map_camera.rotation *=
        Eigen::Quaterniond(Eigen::AngleAxisd(deg * std::numbers::pi / 180, Eigen::Vector3d::UnitX()));
  EXPECT_NEAR(compare(turned, reference, 2).rotation_deg.rmse, std::sqrt(50.0), 1e-6);
}

// The estimate lives in a frame turned by 90 degrees: its uncertain x is the reference's y.
TEST(TrajectoryErrorTest, TheCovarianceIsTurnedWithTheAlignment) {
  const Rigid3 T_reference_estimate{Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitZ())), {1, 2, 3}};
  EstimatedTrajectory estimate = off_by({0});
  EstimatedPose& pose = estimate.poses[0];
  Rigid3 off = truth_at(0);
  off.translation.y() += 0.2;  // along y of the reference
  pose.T_map_camera = T_reference_estimate.inverse() * off;
  Matrix6d covariance = Matrix6d::Identity() * 1e-4;
  covariance(0, 0) = 0.04;  // 20 cm along x of the estimate
  pose.covariance = covariance;
  const TrajectoryErrors e = compare(estimate, reference, 1, T_reference_estimate);
  EXPECT_NEAR(e.nees_mean, 1, 1e-6);
  EXPECT_EQ(e.share_inside_95, 1);
}

TEST(TrajectoryErrorTest, NothingToCompare) {
  const TrajectoryErrors none = compare({}, reference, 0, align_by_poses({}, reference));
  EXPECT_EQ(none.num_compared, 0U);
  EXPECT_EQ(none.share_within[0], 0);
  const auto no_reference = [](std::int64_t) { return std::optional<Rigid3>(); };
  const TrajectoryErrors e = compare(off_by({0, 0}), no_reference, 2);
  EXPECT_EQ(e.num_localized, 2U);
  EXPECT_EQ(e.num_compared, 0U);
}

}  // namespace
}  // namespace camloc::tools
