// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/optimize/terms/relative_pose.h"

namespace camloc {

PoseResidual<6, 2> PoseGraphEdge::linearize(const std::array<Rigid3, 2>& T_map_pose) const {
  const Rigid3 predicted = T_map_pose[0].inverse() * T_map_pose[1];
  const Eigen::Matrix3d R_i_j = predicted.rotation.toRotationMatrix();
  PoseResidual<6, 2> term{pose_error(T_i_j, predicted), {Matrix6d::Zero(), Matrix6d::Zero()}};
  const Eigen::Matrix3d D = inverse_right_jacobian(term.residual.tail<3>());
  auto& [J_i, J_j] = term.J;
  J_i.topLeftCorner<3, 3>().setIdentity();
  J_i.topRightCorner<3, 3>() = -cross_matrix(predicted.translation);
  J_i.bottomRightCorner<3, 3>() = D;
  J_j.topLeftCorner<3, 3>() = -R_i_j;
  J_j.bottomRightCorner<3, 3>() = -D * R_i_j;
  whiten(covariance, &term);
  return term;
}

}  // namespace camloc
