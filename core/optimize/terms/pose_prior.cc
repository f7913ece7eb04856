// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/optimize/terms/pose_prior.h"

namespace camloc {

PoseResidual<6, 1> PoseGraphPrior::linearize(const std::array<Rigid3, 1>& T_map_pose) const {
  const Eigen::Matrix3d R_map_i = T_map_pose[0].rotation.toRotationMatrix();
  PoseResidual<6, 1> term{pose_error(T_map_i, T_map_pose[0]), {Matrix6d::Zero()}};
  term.J[0].topLeftCorner<3, 3>() = -R_map_i;
  term.J[0].bottomRightCorner<3, 3>() = -inverse_right_jacobian(term.residual.tail<3>()) * R_map_i;
  whiten(covariance, &term);
  return term;
}

}  // namespace camloc
