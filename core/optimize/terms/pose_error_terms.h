// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What the terms on whole poses have in common: the derivative of pose_error()'s rotation, and whitening by a covariance.
#pragma once

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

#include "core/geometry/rigid3.h"
#include "core/optimize/terms/pose_terms.h"

namespace camloc {

[[nodiscard]] inline Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// D with log(exp(r) exp(d)) = r + D d for small d: the inverse right Jacobian of SO(3).
[[nodiscard]] inline Eigen::Matrix3d inverse_right_jacobian(const Eigen::Vector3d& r) {
  const Eigen::Matrix3d cross = cross_matrix(r);
  const double angle_squared = r.squaredNorm(), angle = std::sqrt(angle_squared);
  // The series below 1e-2 rad: the closed form loses digits there.
  const double factor = angle < 1e-2 ? 1.0 / 12.0 + angle_squared / 720.0 : (1.0 - 0.5 * angle / std::tan(0.5 * angle)) / angle_squared;
  return Eigen::Matrix3d::Identity() + 0.5 * cross + factor * cross * cross;
}

/// Residuals and derivatives times L^-1, with covariance = L L'. Where it is not positive definite, or the residual not finite, the
/// residual becomes infinite and the derivatives zero.
template <int kPoses>
void whiten(const Matrix6d& covariance, PoseResidual<6, kPoses>* term) {
  const Eigen::LLT<Matrix6d> factor(covariance);
  if (covariance.allFinite() && factor.info() == Eigen::Success && term->residual.allFinite()) {
    factor.matrixL().solveInPlace(term->residual);
    for (Matrix6d& J : term->J) factor.matrixL().solveInPlace(J);
    return;
  }
  term->residual.setConstant(std::numeric_limits<double>::infinity());
  for (Matrix6d& J : term->J) J.setZero();
}

}  // namespace camloc
