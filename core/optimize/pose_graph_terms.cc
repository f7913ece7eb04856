// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The derivatives of edges and priors; checked against differences in tests/optimize/pose_graph_test.cc.
#include "core/optimize/pose_graph_terms.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

namespace camloc {
namespace {

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// D with log(exp(r) exp(d)) = r + D d for small d: the inverse right Jacobian of SO(3).
Eigen::Matrix3d inverse_right_jacobian(const Eigen::Vector3d& r) {
  const Eigen::Matrix3d cross = cross_matrix(r);
  const double angle_squared = r.squaredNorm(), angle = std::sqrt(angle_squared);
  // The series below 1e-2 rad: the closed form loses digits there.
  const double factor = angle < 1e-2 ? 1.0 / 12.0 + angle_squared / 720.0 : (1.0 - 0.5 * angle / std::tan(0.5 * angle)) / angle_squared;
  return Eigen::Matrix3d::Identity() + 0.5 * cross + factor * cross * cross;
}

/// Whitens the residual and its derivatives by the covariance, or makes the term infinite.
template <class... Matrices>
void whiten(const Matrix6d& covariance, Vector6d* residual, Matrices*... jacobians) {
  const Eigen::LLT<Matrix6d> factor(covariance);
  if (covariance.allFinite() && factor.info() == Eigen::Success && residual->allFinite()) {
    factor.matrixL().solveInPlace(*residual);
    (factor.matrixL().solveInPlace(*jacobians), ...);
    return;
  }
  residual->setConstant(std::numeric_limits<double>::infinity());
  (jacobians->setZero(), ...);
}

}  // namespace

EdgeTerm edge_term(const PoseGraphEdge& edge, const Rigid3& T_map_i, const Rigid3& T_map_j) {
  const Rigid3 predicted = T_map_i.inverse() * T_map_j;
  const Eigen::Matrix3d R_i_j = predicted.rotation.toRotationMatrix();
  EdgeTerm term{pose_error(edge.T_i_j, predicted), Matrix6d::Zero(), Matrix6d::Zero()};
  const Eigen::Matrix3d D = inverse_right_jacobian(term.residual.tail<3>());
  term.J_i.topLeftCorner<3, 3>().setIdentity();
  term.J_i.topRightCorner<3, 3>() = -cross_matrix(predicted.translation);
  term.J_i.bottomRightCorner<3, 3>() = D;
  term.J_j.topLeftCorner<3, 3>() = -R_i_j;
  term.J_j.bottomRightCorner<3, 3>() = -D * R_i_j;
  whiten(edge.covariance, &term.residual, &term.J_i, &term.J_j);
  return term;
}

PriorTerm prior_term(const PoseGraphPrior& prior, const Rigid3& T_map_i) {
  const Eigen::Matrix3d R_map_i = T_map_i.rotation.toRotationMatrix();
  PriorTerm term{pose_error(prior.T_map_i, T_map_i), Matrix6d::Zero()};
  term.J.topLeftCorner<3, 3>() = -R_map_i;
  term.J.bottomRightCorner<3, 3>() = -inverse_right_jacobian(term.residual.tail<3>()) * R_map_i;
  whiten(prior.covariance, &term.residual, &term.J);
  return term;
}

}  // namespace camloc
