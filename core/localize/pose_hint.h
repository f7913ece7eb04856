// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What somebody who knows better says about where the camera is: a person at a terminal, a docking station, another localizer.
// It is a place to look first and never evidence: a pose found there must pass the same verification as any other.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace camloc {

struct PoseHint {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  ///< of the camera, in the map
  double yaw_rad = 0;                                    ///< heading of the optical axis about the map's z axis, from x towards y
  double radius_m = 1;                                   ///< the camera is this near to the position

  [[nodiscard]] bool is_valid() const {
    return position_m.allFinite() && std::isfinite(yaw_rad) && radius_m > 0 && radius_m <= kMaxRadiusM;
  }
  static constexpr double kMaxRadiusM = 20;
};

}  // namespace camloc
