// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Poses from relative measurements between them: the step that spreads the error of a closed loop (Grisetti, Kummerle,
// Stachniss, Burgard, "A tutorial on graph-based SLAM", 2010), on SE(3), robust, with a sparse Cholesky factorization.
#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/rigid3.h"
#include "core/optimize/terms/pose_prior.h"
#include "core/optimize/terms/relative_pose.h"

namespace camloc {

struct PoseGraph {
  std::vector<Rigid3> T_map_pose;
  std::vector<std::uint8_t> is_fixed;  ///< as many as poses
  std::vector<PoseGraphEdge> edges;
  std::vector<PoseGraphPrior> priors;
};

struct PoseGraphReport {
  int num_iterations = 0;
  double initial_cost = 0, final_cost = 0;
  bool is_converged = false;
  /// Squared Mahalanobis distance of each edge and prior at the end: 6 degrees of freedom when the covariances are honest.
  std::vector<double> edge_chi2, prior_chi2;
};

/// Moves the poses in place. Every connected part needs a fixed pose or a prior. The same graph gives the same bits.
/// `kernel_sigmas`: width of the Cauchy kernel over the Mahalanobis distance of edges and priors; 0 = none.
PoseGraphReport optimize_pose_graph(PoseGraph* graph, double kernel_sigmas = 0);

}  // namespace camloc
