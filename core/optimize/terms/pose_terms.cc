// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/optimize/terms/pose_terms.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

namespace camloc {

Eigen::Matrix3d inverse_right_jacobian(const Eigen::Vector3d& r) {
  const Eigen::Matrix3d cross = cross_matrix(r);
  const double angle_squared = r.squaredNorm(), angle = std::sqrt(angle_squared);
  // The series below 1e-2 rad: the closed form loses digits there.
  const double factor = angle < 1e-2 ? 1.0 / 12.0 + angle_squared / 720.0 : (1.0 - 0.5 * angle / std::tan(0.5 * angle)) / angle_squared;
  return Eigen::Matrix3d::Identity() + 0.5 * cross + factor * cross * cross;
}

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

template void whiten<1>(const Matrix6d&, PoseResidual<6, 1>*);
template void whiten<2>(const Matrix6d&, PoseResidual<6, 2>*);

}  // namespace camloc
