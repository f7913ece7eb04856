// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Poses from relative measurements between them: the step that spreads the error of a closed loop (Grisetti, Kummerle,
// Stachniss, Burgard, "A tutorial on graph-based SLAM", 2010), on SE(3), robust, with a sparse Cholesky factorization.
#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/rigid3.h"

namespace camloc {

/// Pose j as seen from pose i, with the covariance of pose_error() of T_i_j (metres then radians, axes of i).
struct PoseGraphEdge {
  std::uint32_t i = 0, j = 0;
  Rigid3 T_i_j;
  Matrix6d covariance = Matrix6d::Identity();
};

/// Where a pose is in the map, e.g. from localization in another map; covariance of pose_error() in the axes of `map`.
struct PoseGraphPrior {
  std::uint32_t i = 0;
  Rigid3 T_map_i;
  Matrix6d covariance = Matrix6d::Identity();
};

struct PoseGraph {
  std::vector<Rigid3> T_map_pose;
  std::vector<std::uint8_t> is_fixed;  ///< as many as poses
  std::vector<PoseGraphEdge> edges;
  std::vector<PoseGraphPrior> priors;
};

struct PoseGraphOptions {
  int max_iterations = 30;
  double min_relative_decrease = 1e-6;
  double kernel_sigmas = 0;  ///< width of the Cauchy kernel over the Mahalanobis distance of edges and priors; 0 = none
};

struct PoseGraphReport {
  int num_iterations = 0;
  double initial_cost = 0, final_cost = 0;
  bool is_converged = false;
  /// Squared Mahalanobis distance of each edge and prior at the end: 6 degrees of freedom when the covariances are honest.
  std::vector<double> edge_chi2, prior_chi2;
};

/// Moves the poses in place. Every connected part needs a fixed pose or a prior. The same graph gives the same bits.
PoseGraphReport optimize_pose_graph(const PoseGraphOptions& options, PoseGraph* graph);

}  // namespace camloc
