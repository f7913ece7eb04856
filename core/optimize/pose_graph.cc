// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Levenberg-Marquardt over the poses that are not fixed. A pose changes in its own axes, see pose_jacobian.h.
#include "core/optimize/pose_graph.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "core/geometry/pose_jacobian.h"
#include "core/optimize/block_system.h"
#include "core/optimize/pose_graph_terms.h"

namespace camloc {
namespace {

constexpr double kFirstDamping = 1e-6, kMinDamping = 1e-10, kMaxDamping = 1e8;
constexpr std::uint32_t kFixed = std::numeric_limits<std::uint32_t>::max();

/// Robust cost and the weight of a squared Mahalanobis distance: Cauchy's kernel, or none.
struct Robust {
  double cost, weight;
};

Robust robust(double chi2, double kernel_sigmas) {
  if (!(chi2 < std::numeric_limits<double>::infinity())) return {0.0, 0.0};  // a term that is left out
  if (!(kernel_sigmas > 0)) return {chi2, 1.0};
  const double c2 = kernel_sigmas * kernel_sigmas;
  return {c2 * std::log1p(chi2 / c2), 1.0 / (1.0 + chi2 / c2)};
}

class PoseGraphSolver {
 public:
  PoseGraphSolver(const PoseGraphOptions& options, PoseGraph* graph)
      : options_(options), graph_(*graph), free_index_(number_free_poses(*graph)), system_(pattern_of(*graph, free_index_)) {}

  PoseGraphReport run();

 private:
  static std::vector<std::uint32_t> number_free_poses(const PoseGraph& graph);
  static BlockPattern pattern_of(const PoseGraph& graph, const std::vector<std::uint32_t>& free_index);
  [[nodiscard]] double cost_of(const std::vector<Rigid3>& poses) const;
  void assemble();
  void add_term(const Matrix6d& J, const Vector6d& residual, double weight, std::uint32_t row);
  void damp(double damping);
  [[nodiscard]] std::vector<Rigid3> moved(const std::vector<Vector6d>& step) const;

  const PoseGraphOptions& options_;
  PoseGraph& graph_;
  std::vector<std::uint32_t> free_index_;
  BlockSystem system_;
};

std::vector<std::uint32_t> PoseGraphSolver::number_free_poses(const PoseGraph& graph) {
  std::vector<std::uint32_t> free_index(graph.T_map_pose.size(), kFixed);
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < free_index.size(); ++i) {
    if (graph.is_fixed[i] == 0) free_index[i] = count++;
  }
  return free_index;
}

BlockPattern PoseGraphSolver::pattern_of(const PoseGraph& graph, const std::vector<std::uint32_t>& free_index) {
  const auto num_free = free_index.size() - static_cast<std::size_t>(std::count(free_index.begin(), free_index.end(), kFixed));
  BlockPattern pattern(static_cast<std::uint32_t>(num_free));
  for (const PoseGraphEdge& edge : graph.edges) {
    const std::uint32_t i = free_index[edge.i], j = free_index[edge.j];
    if (i != kFixed && j != kFixed) pattern.add(i, j);
  }
  return pattern;
}

double PoseGraphSolver::cost_of(const std::vector<Rigid3>& poses) const {
  double cost = 0;
  for (const PoseGraphEdge& edge : graph_.edges) {
    cost += robust(edge_term(edge, poses[edge.i], poses[edge.j]).residual.squaredNorm(), options_.kernel_sigmas).cost;
  }
  for (const PoseGraphPrior& prior : graph_.priors) {
    cost += robust(prior_term(prior, poses[prior.i]).residual.squaredNorm(), options_.kernel_sigmas).cost;
  }
  return cost;
}

void PoseGraphSolver::add_term(const Matrix6d& J, const Vector6d& residual, double weight, std::uint32_t row) {
  if (row == kFixed) return;
  Eigen::Map<Matrix6d>(system_.block(row, row)).noalias() += weight * J.transpose() * J;
  system_.gradient(row).noalias() += weight * J.transpose() * residual;
}

void PoseGraphSolver::assemble() {
  system_.set_zero();
  for (const PoseGraphEdge& edge : graph_.edges) {
    const std::uint32_t i = free_index_[edge.i], j = free_index_[edge.j];
    const EdgeTerm term = edge_term(edge, graph_.T_map_pose[edge.i], graph_.T_map_pose[edge.j]);
    const double weight = robust(term.residual.squaredNorm(), options_.kernel_sigmas).weight;
    if (weight == 0.0 || edge.i == edge.j) continue;
    add_term(term.J_i, term.residual, weight, i);
    add_term(term.J_j, term.residual, weight, j);
    if (i == kFixed || j == kFixed) continue;
    Eigen::Map<Matrix6d> block(system_.block(std::min(i, j), std::max(i, j)));
    if (i < j)
      block.noalias() += weight * term.J_i.transpose() * term.J_j;
    else
      block.noalias() += weight * term.J_j.transpose() * term.J_i;
  }
  for (const PoseGraphPrior& prior : graph_.priors) {
    const PriorTerm term = prior_term(prior, graph_.T_map_pose[prior.i]);
    const double weight = robust(term.residual.squaredNorm(), options_.kernel_sigmas).weight;
    if (weight > 0.0) add_term(term.J, term.residual, weight, free_index_[prior.i]);
  }
}

/// Marquardt's damping; a pose that nothing measures keeps its place.
void PoseGraphSolver::damp(double damping) {
  for (std::uint32_t i = 0; i < system_.num_blocks(); ++i) {
    Eigen::Map<Matrix6d> block(system_.block(i, i));
    for (int k = 0; k < 6; ++k) block(k, k) = block(k, k) > 0 ? block(k, k) * (1.0 + damping) : 1.0;
  }
}

std::vector<Rigid3> PoseGraphSolver::moved(const std::vector<Vector6d>& step) const {
  std::vector<Rigid3> poses = graph_.T_map_pose;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (free_index_[i] != kFixed) poses[i] = moved_in_camera_axes(poses[i], step[free_index_[i]]);
  }
  return poses;
}

PoseGraphReport PoseGraphSolver::run() {
  PoseGraphReport report;
  double cost = cost_of(graph_.T_map_pose), damping = kFirstDamping;
  report.initial_cost = cost;
  report.is_converged = system_.num_blocks() == 0 || cost == 0.0;
  std::vector<Vector6d> step;
  while (!report.is_converged && report.num_iterations < options_.max_iterations && damping < kMaxDamping) {
    ++report.num_iterations;
    assemble();
    damp(damping);
    std::vector<Rigid3> trial;
    double trial_cost = std::numeric_limits<double>::infinity();
    if (system_.solve(&step)) {
      trial = moved(step);
      trial_cost = cost_of(trial);
    }
    if (trial_cost <= cost) {
      report.is_converged = cost - trial_cost <= options_.min_relative_decrease * cost;
      graph_.T_map_pose = std::move(trial);
      cost = trial_cost;
      damping = std::max(damping * 0.1, kMinDamping);
    } else {
      damping *= 10;
    }
  }
  report.final_cost = cost;
  for (const PoseGraphEdge& edge : graph_.edges) {
    report.edge_chi2.push_back(edge_term(edge, graph_.T_map_pose[edge.i], graph_.T_map_pose[edge.j]).residual.squaredNorm());
  }
  for (const PoseGraphPrior& prior : graph_.priors) {
    report.prior_chi2.push_back(prior_term(prior, graph_.T_map_pose[prior.i]).residual.squaredNorm());
  }
  return report;
}

}  // namespace

PoseGraphReport optimize_pose_graph(const PoseGraphOptions& options, PoseGraph* graph) {
  assert(graph->is_fixed.size() == graph->T_map_pose.size());
  return PoseGraphSolver(options, graph).run();
}

}  // namespace camloc
