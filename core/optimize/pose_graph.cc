// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Levenberg-Marquardt over the poses that are not fixed. A pose changes in its own axes, see pose_jacobian.h.
#include "core/optimize/pose_graph.h"

#include <algorithm>
#include <cassert>
#include <limits>

#include "core/geometry/pose_jacobian.h"

namespace camloc {
namespace {

constexpr int kMaxIterations = 30;
constexpr double kMinRelativeDecrease = 1e-6;
constexpr double kFirstDamping = 1e-6, kMinDamping = 1e-10, kMaxDamping = 1e8;
class PoseGraphSolver {
 public:
  PoseGraphSolver(PoseGraph* graph, double kernel_sigmas)
      : graph_(*graph),
        edges_(graph->edges, kernel_sigmas),
        priors_(graph->priors, kernel_sigmas),
        rows_(rows_of_poses(graph->is_fixed)),
        equations_(pattern()) {}

  PoseGraphReport run() {
    PoseGraphReport report;
    double cost = cost_of(graph_.T_map_pose), damping = kFirstDamping;
    report.initial_cost = cost;
    report.is_converged = equations_.num_blocks() == 0 || cost == 0.0;
    std::vector<Vector6d> step;
    while (!report.is_converged && report.num_iterations < kMaxIterations && damping < kMaxDamping) {
      ++report.num_iterations;
      assemble();
      damp(damping);
      std::vector<Rigid3> trial;
      double trial_cost = std::numeric_limits<double>::infinity();
      if (equations_.solve(&step)) {
        trial = moved(step);
        trial_cost = cost_of(trial);
      }
      if (trial_cost <= cost) {
        report.is_converged = cost - trial_cost <= kMinRelativeDecrease * cost;
        graph_.T_map_pose = std::move(trial);
        cost = trial_cost;
        damping = std::max(damping * 0.1, kMinDamping);
      } else {
        damping *= 10;
      }
    }
    report.final_cost = cost;
    report.edge_chi2 = edges_.chi2(graph_.T_map_pose);
    report.prior_chi2 = priors_.chi2(graph_.T_map_pose);
    return report;
  }

 private:
  BlockPattern pattern() const {
    BlockPattern pattern(num_free_poses(rows_));
    edges_.mark(rows_, &pattern);
    return pattern;
  }
  [[nodiscard]] double cost_of(const std::vector<Rigid3>& poses) const { return priors_.add_cost(poses, edges_.add_cost(poses, 0)); }

  void assemble() {
    equations_.set_zero();
    (void)edges_.add(graph_.T_map_pose, rows_, 0, &equations_);
    (void)priors_.add(graph_.T_map_pose, rows_, 0, &equations_);
  }

  /// Marquardt's damping; a pose that nothing measures keeps its place.
  void damp(double damping) {
    for (std::uint32_t i = 0; i < equations_.num_blocks(); ++i) {
      Eigen::Map<Matrix6d> block(equations_.block(i, i));
      for (int k = 0; k < 6; ++k) block(k, k) = block(k, k) > 0 ? block(k, k) * (1.0 + damping) : 1.0;
    }
  }

  std::vector<Rigid3> moved(const std::vector<Vector6d>& step) const {
    std::vector<Rigid3> poses = graph_.T_map_pose;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      if (rows_[i] != kFixedPose) poses[i] = moved_in_camera_axes(poses[i], step[rows_[i]]);
    }
    return poses;
  }

  PoseGraph& graph_;
  PoseTermsOf<PoseGraphEdge> edges_;
  PoseTermsOf<PoseGraphPrior> priors_;
  std::vector<std::uint32_t> rows_;
  BlockSystem equations_;
};

}  // namespace

PoseGraphReport optimize_pose_graph(PoseGraph* graph, double kernel_sigmas) {
  assert(graph->is_fixed.size() == graph->T_map_pose.size());
  return PoseGraphSolver(graph, kernel_sigmas).run();
}

}  // namespace camloc
