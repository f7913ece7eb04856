// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Pose graphs whose truth is known.
#include "core/slam/pose_graph.h"

#include <gtest/gtest.h>

#include "core/geometry/pose_jacobian.h"
#include "core/slam/pose_graph_terms.h"
#include "tests/geometry/generated.h"

namespace camloc {
namespace {

Matrix6d random_covariance(std::mt19937& rng) {
  Matrix6d A;
  std::normal_distribution<double> normal(0.0, 0.1);
  for (int i = 0; i < 36; ++i) A(i) = normal(rng);
  return A * A.transpose() + 0.01 * Matrix6d::Identity();
}

TEST(PoseGraph, EdgeDerivativesAgreeWithDifferences) {
  std::mt19937 rng(1);
  for (int i = 0; i < 50; ++i) {
    const Rigid3 T_map_i = testing::random_pose(rng, 3), T_map_j = testing::random_pose(rng, 3);
    // The measurement is near the prediction, or far from it.
    const Rigid3 measured = testing::disturbed(rng, T_map_i.inverse() * T_map_j, 0.5, i % 2 == 0 ? 1e-4 : 0.8);
    const PoseGraphEdge edge{0, 1, measured, random_covariance(rng)};
    const EdgeTerm term = edge_term(edge, T_map_i, T_map_j);
    for (int k = 0; k < 6; ++k) {
      const Vector6d step = 1e-6 * Vector6d::Unit(k);
      const Vector6d by_i = (edge_term(edge, moved_in_camera_axes(T_map_i, step), T_map_j).residual -
                             edge_term(edge, moved_in_camera_axes(T_map_i, -step), T_map_j).residual) / 2e-6;
      const Vector6d by_j = (edge_term(edge, T_map_i, moved_in_camera_axes(T_map_j, step)).residual -
                             edge_term(edge, T_map_i, moved_in_camera_axes(T_map_j, -step)).residual) / 2e-6;
      EXPECT_LT((by_i - term.J_i.col(k)).norm(), 1e-6 * (1 + by_i.norm()));
      EXPECT_LT((by_j - term.J_j.col(k)).norm(), 1e-6 * (1 + by_j.norm()));
    }
  }
}

TEST(PoseGraph, PriorDerivativesAgreeWithDifferences) {
  std::mt19937 rng(2);
  for (int i = 0; i < 50; ++i) {
    const Rigid3 T_map_i = testing::random_pose(rng, 3);
    const PoseGraphPrior prior{0, testing::disturbed(rng, T_map_i, 0.5, i % 2 == 0 ? 1e-4 : 0.8), random_covariance(rng)};
    const PriorTerm term = prior_term(prior, T_map_i);
    for (int k = 0; k < 6; ++k) {
      const Vector6d step = 1e-6 * Vector6d::Unit(k);
      const Vector6d difference = (prior_term(prior, moved_in_camera_axes(T_map_i, step)).residual -
                                   prior_term(prior, moved_in_camera_axes(T_map_i, -step)).residual) / 2e-6;
      EXPECT_LT((difference - term.J.col(k)).norm(), 1e-6 * (1 + difference.norm()));
    }
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
  const PoseGraphReport report = optimize_pose_graph({}, &loop.graph);
  EXPECT_TRUE(report.is_converged);
  EXPECT_LT(error_m(loop.graph.T_map_pose, loop.truth), 0.5 * before);
  EXPECT_LT(pose_error(loop.truth[0], loop.graph.T_map_pose[0]).norm(), 1e-15);
  EXPECT_LT(report.edge_chi2.back(), 16.8);  // 99 % of chi2 with 6 degrees of freedom
}

}  // namespace
}  // namespace camloc
