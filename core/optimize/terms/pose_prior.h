// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Where a pose is in the map, e.g. from localization in another map: residual L^-1 pose_error(measured, predicted), with covariance =
// L L'.
#pragma once

#include "core/optimize/terms/pose_terms.h"

namespace camloc {

/// Covariance of pose_error() in the axes of `map`. One that is not finite, or has no positive definite covariance, takes no part.
struct PoseGraphPrior {
  static constexpr int kRows = 6, kPoses = 1;

  std::uint32_t i = 0;
  Rigid3 T_map_i;
  Matrix6d covariance = Matrix6d::Identity();

  [[nodiscard]] std::array<std::uint32_t, 1> poses() const { return {i}; }

  [[nodiscard]] PoseResidual<6, 1> linearize(const std::array<Rigid3, 1>& T_map_pose) const;
};

}  // namespace camloc
