// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A landmark whose position is known, e.g. a surveyed control point: residual (X - position) / sigma, without a robust kernel. A
// surveyor who is wrong is found by comparing, not by weighing (tools/mapping/site).
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>

namespace camloc {

struct PointPrior {
  std::uint32_t landmark = 0;
  Eigen::Vector3d position_m;  ///< in `map`
  double sigma_m = 0.01;       ///< per axis

  /// One that is not takes no part.
  [[nodiscard]] bool is_usable() const { return position_m.allFinite() && sigma_m > 0 && std::isfinite(sigma_m); }

  [[nodiscard]] double cost(const Eigen::Vector3d& X) const { return weight() * (X - position_m).squaredNorm(); }
  [[nodiscard]] double weight() const { return 1.0 / (sigma_m * sigma_m); }
};

}  // namespace camloc
