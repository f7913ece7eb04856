// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Inside of pose_graph.cc and bundle_adjustment.cc: whitened residuals of edges and priors and their derivatives by the poses,
// each pose changing in its own axes (see pose_jacobian.h).
#pragma once

#include "core/optimize/pose_graph.h"

namespace camloc {

/// residual = L^-1 pose_error(measured, predicted) with covariance = L L', and its derivatives. Where the covariance is not
/// positive definite or the measurement not finite, the residual is infinite and the derivatives are zero.
struct EdgeTerm {
  Vector6d residual;
  Matrix6d J_i, J_j;
};

struct PriorTerm {
  Vector6d residual;
  Matrix6d J;
};

[[nodiscard]] EdgeTerm edge_term(const PoseGraphEdge& edge, const Rigid3& T_map_i, const Rigid3& T_map_j);
[[nodiscard]] PriorTerm prior_term(const PoseGraphPrior& prior, const Rigid3& T_map_i);

}  // namespace camloc
