// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Two poses relative to each other, measured otherwise than by landmarks: residual L^-1 pose_error(measured, predicted), with
// covariance = L L'.
#pragma once

#include "core/optimize/terms/pose_terms.h"

namespace camloc {

/// Pose j as seen from pose i, with the covariance of pose_error() of T_i_j (metres then radians, axes of i). One that is not
/// finite, or has no positive definite covariance, takes no part.
struct PoseGraphEdge {
  static constexpr int kRows = 6, kPoses = 2;

  std::uint32_t i = 0, j = 0;
  Rigid3 T_i_j;
  Matrix6d covariance = Matrix6d::Identity();

  [[nodiscard]] std::array<std::uint32_t, 2> poses() const { return {i, j}; }

  [[nodiscard]] PoseResidual<6, 2> linearize(const std::array<Rigid3, 2>& T_map_pose) const;
};

}  // namespace camloc
