// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Pose graphs whose truth is known.
#include "core/optimize/pose_graph.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "tests/geometry/generated.h"
#include "tests/optimize/pose_term_derivatives.h"

namespace camloc {
namespace {

Matrix6d random_covariance(std::mt19937& rng) {
  Matrix6d A;
  std::normal_distribution<double> normal(0.0, 0.1);
  for (int i = 0; i < 36; ++i) A(i) = normal(rng);
  return A * A.transpose() + 0.01 * Matrix6d::Identity();
}

TEST(PoseGraph, DerivativesOfEdgesAndPriorsAgreeWithDifferences) {
  std::mt19937 rng(1);
  for (int i = 0; i < 50; ++i) {
    const Rigid3 T_map_i = testing::random_pose(rng, 3), T_map_j = testing::random_pose(rng, 3);
    // The measurement is near the prediction, or far from it.
    const double off_rad = i % 2 == 0 ? 1e-4 : 0.8;
    const PoseGraphEdge edge{0, 1, testing::disturbed(rng, T_map_i.inverse() * T_map_j, 0.5, off_rad), random_covariance(rng)};
    testing::expect_true_derivatives(edge, std::array{T_map_i, T_map_j});
    const PoseGraphPrior prior{0, testing::disturbed(rng, T_map_i, 0.5, off_rad), random_covariance(rng)};
    testing::expect_true_derivatives(prior, std::array{T_map_i});
  }
}

Matrix6d diagonal_covariance(double position_sigma_m, double rotation_sigma_rad) {
  Vector6d variances;
  variances.head<3>().setConstant(position_sigma_m * position_sigma_m);
  variances.tail<3>().setConstant(rotation_sigma_rad * rotation_sigma_rad);
  return variances.asDiagonal();
}

/// A walk around a circle whose chain of measurements drifts, closed by one exact edge.
struct Loop {
  std::vector<Rigid3> truth;
  PoseGraph graph;
};

Loop make_loop(std::mt19937& rng, std::uint32_t num_poses, double position_sigma_m, double rotation_sigma_rad) {
  Loop loop;
  for (std::uint32_t i = 0; i < num_poses; ++i) {
    const double angle = 2 * std::numbers::pi * i / num_poses;
    loop.truth.push_back({exp_so3({0, 0, angle}), {10 * std::cos(angle), 10 * std::sin(angle), 0}});
  }
  const Matrix6d covariance = diagonal_covariance(position_sigma_m, rotation_sigma_rad);
  loop.graph.T_map_pose = {loop.truth[0]};
  for (std::uint32_t i = 0; i + 1 < num_poses; ++i) {
    const Rigid3 measured = testing::disturbed(rng, loop.truth[i].inverse() * loop.truth[i + 1], position_sigma_m, rotation_sigma_rad);
    loop.graph.edges.push_back({i, i + 1, measured, covariance});
    loop.graph.T_map_pose.push_back(loop.graph.T_map_pose.back() * measured);
  }
  loop.graph.edges.push_back({num_poses - 1, 0, loop.truth.back().inverse() * loop.truth.front(), diagonal_covariance(1e-3, 1e-4)});
  loop.graph.is_fixed.assign(num_poses, 0);
  loop.graph.is_fixed[0] = 1;
  return loop;
}

double error_m(const std::vector<Rigid3>& poses, const std::vector<Rigid3>& truth) {
  double sum = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) sum += (poses[i].translation - truth[i].translation).squaredNorm();
  return std::sqrt(sum / static_cast<double>(poses.size()));
}

TEST(PoseGraph, SpreadsTheErrorOfALoop) {
  std::mt19937 rng(3);
  Loop loop = make_loop(rng, 200, 0.01, 0.01);
  const double before = error_m(loop.graph.T_map_pose, loop.truth);
  const PoseGraphReport report = optimize_pose_graph(&loop.graph);
  EXPECT_TRUE(report.is_converged);
  EXPECT_LT(error_m(loop.graph.T_map_pose, loop.truth), 0.5 * before);
  EXPECT_LT(pose_error(loop.truth[0], loop.graph.T_map_pose[0]).norm(), 1e-15);
  EXPECT_LT(report.edge_chi2.back(), 16.8);  // 99 % of chi2 with 6 degrees of freedom
}

TEST(PoseGraph, KernelWithstandsFalseLoops) {
  std::mt19937 rng(4);
  Loop loop = make_loop(rng, 200, 0.01, 0.002);
  const Rigid3 wrong{exp_so3({0, 0, 1}), {0.5, 0.5, 0}};
  for (std::uint32_t i = 0; i < 5; ++i) { loop.graph.edges.push_back({20 * i, 20 * i + 70, wrong, diagonal_covariance(0.02, 0.01)}); }
  PoseGraph without_kernel = loop.graph, without_false_loops = loop.graph;
  without_false_loops.edges.resize(200);
  PoseGraphReport report;
  for (int i = 0; i < 4 && !report.is_converged; ++i) report = optimize_pose_graph(&loop.graph, 3);
  optimize_pose_graph(&without_kernel);
  optimize_pose_graph(&without_false_loops);
  EXPECT_LT(error_m(loop.graph.T_map_pose, without_false_loops.T_map_pose), 0.05);
  EXPECT_GT(error_m(without_kernel.T_map_pose, loop.truth), 1.0);
  for (std::size_t i = 0; i < 200; ++i) EXPECT_LT(report.edge_chi2[i], 40);
  for (std::size_t i = 200; i < 205; ++i) EXPECT_GT(report.edge_chi2[i], 1000);
}

TEST(PoseGraph, PriorsHoldAFreeGraph) {
  std::mt19937 rng(5);
  Loop loop = make_loop(rng, 100, 0.01, 0.002);
  loop.graph.is_fixed[0] = 0;
  const Rigid3 T_off{exp_so3({0.1, 0.2, 0.3}), {3, 2, 1}};
  for (Rigid3& T : loop.graph.T_map_pose) T = T_off * T;
  for (const std::uint32_t i : {0U, 50U}) loop.graph.priors.push_back({i, loop.truth[i], diagonal_covariance(0.01, 0.002)});
  const PoseGraphReport report = optimize_pose_graph(&loop.graph);
  EXPECT_TRUE(report.is_converged);
  EXPECT_LT(error_m(loop.graph.T_map_pose, loop.truth), 0.15);
  ASSERT_EQ(report.prior_chi2.size(), 2U);
  EXPECT_LT(report.prior_chi2[0], 16.8);
  double cost = report.prior_chi2[0] + report.prior_chi2[1];
  for (const double chi2 : report.edge_chi2) cost += chi2;
  EXPECT_NEAR(cost, report.final_cost, 1e-9 * cost);
}

TEST(PoseGraph, BadMeasurementsAreLeftOut) {
  std::mt19937 rng(6);
  Loop loop = make_loop(rng, 50, 0.01, 0.002);
  PoseGraph bad = loop.graph;
  bad.edges.push_back({3, 30, Rigid3{}, Matrix6d::Zero()});
  bad.edges.push_back({3, 30, Rigid3{}, -Matrix6d::Identity()});
  bad.edges.push_back({3, 30, Rigid3{}, Matrix6d::Constant(std::numeric_limits<double>::quiet_NaN())});
  bad.edges.push_back(
      {3, 30, Rigid3{Eigen::Quaterniond::Identity(), {std::numeric_limits<double>::infinity(), 0, 0}}, Matrix6d::Identity()});
  const PoseGraphReport report = optimize_pose_graph(&bad);
  optimize_pose_graph(&loop.graph);
  for (std::size_t i = 50; i < 54; ++i) EXPECT_TRUE(std::isinf(report.edge_chi2[i]));
  EXPECT_LT(error_m(bad.T_map_pose, loop.graph.T_map_pose), 1e-9);
}

TEST(PoseGraph, PoseWithoutMeasurementKeepsItsPlace) {
  std::mt19937 rng(7);
  Loop loop = make_loop(rng, 50, 0.01, 0.002);
  const Rigid3 lonely{exp_so3({1, 2, 3}), {4, 5, 6}};
  loop.graph.T_map_pose.push_back(lonely);
  loop.graph.is_fixed.push_back(0);
  optimize_pose_graph(&loop.graph);
  EXPECT_EQ(loop.graph.T_map_pose.back().translation, lonely.translation);
}

TEST(PoseGraph, NothingToDo) {
  PoseGraph empty;
  EXPECT_TRUE(optimize_pose_graph(&empty).is_converged);
  std::mt19937 rng(8);
  Loop loop = make_loop(rng, 20, 0.01, 0.002);
  std::fill(loop.graph.is_fixed.begin(), loop.graph.is_fixed.end(), std::uint8_t{1});
  const PoseGraphReport report = optimize_pose_graph(&loop.graph);
  EXPECT_TRUE(report.is_converged);
  EXPECT_EQ(report.initial_cost, report.final_cost);
  EXPECT_EQ(report.edge_chi2.size(), loop.graph.edges.size());
}

TEST(PoseGraph, LargeGraphHasAnHonestCostAndTheSameBitsTwice) {
  std::mt19937 rng(9);
  Loop loop = make_loop(rng, 5000, 0.005, 0.001);
  std::uniform_int_distribution<std::uint32_t> any(0, 4999), near(2, 10);
  for (int k = 0; k < 45000; ++k) {
    const std::uint32_t i = any(rng), j = (i + near(rng)) % 5000;
    const Rigid3 measured = testing::disturbed(rng, loop.truth[i].inverse() * loop.truth[j], 0.005, 0.001);
    loop.graph.edges.push_back({i, j, measured, diagonal_covariance(0.005, 0.001)});
  }
  PoseGraph again = loop.graph;
  const PoseGraphReport report = optimize_pose_graph(&loop.graph);
  optimize_pose_graph(&again);
  EXPECT_TRUE(report.is_converged);
  EXPECT_NEAR(report.final_cost / (6.0 * (50000 - 5000)), 1.0, 0.02);  // residuals minus unknowns
  for (std::size_t i = 0; i < 5000; ++i) {
    ASSERT_EQ(loop.graph.T_map_pose[i].translation, again.T_map_pose[i].translation);
    ASSERT_EQ(loop.graph.T_map_pose[i].rotation.coeffs(), again.T_map_pose[i].rotation.coeffs());
  }
}

}  // namespace
}  // namespace camloc
