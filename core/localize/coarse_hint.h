// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Roughly where the camera was when a frame was taken, by somebody who has looked at that frame: a neural network, which answers some
// frames later. Like a PoseHint it is a place to look and never evidence; unlike one it is no person's word: it is not looked at
// first, decides between no look-alikes, and may be wrong by more than it says.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/geometry/rigid3.h"

namespace camloc {

struct CoarseHint {
  std::int64_t stamp_ns = 0;  ///< of the frame that it is for
  Rigid3 T_map_camera;
  Matrix6d covariance = Matrix6d::Zero();  ///< of pose_error() at that time

  [[nodiscard]] bool is_valid() const {
    return T_map_camera.translation.allFinite() && std::abs(T_map_camera.rotation.norm() - 1) < 1e-3 && covariance.allFinite() &&
           covariance.diagonal().minCoeff() > 0;
  }
  /// For so long the camera is still about there.
  [[nodiscard]] bool is_current(std::int64_t now_ns) const { return std::abs(now_ns - stamp_ns) <= kMaxAgeNs; }
  /// The covariance for a frame at `now_ns`: heads and robots indoors move by a metre and turn by a radian a second, and nobody knows
  /// which way.
  [[nodiscard]] Matrix6d covariance_at(std::int64_t now_ns) const {
    const double age_s = 1e-9 * static_cast<double>(now_ns - stamp_ns);
    Matrix6d total = covariance;
    total.diagonal().array() += age_s * age_s;
    return total;
  }
  static constexpr std::int64_t kMaxAgeNs = 1'000'000'000;
};

}  // namespace camloc
