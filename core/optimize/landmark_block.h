// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The 3x3 block of one landmark in the equations and its Cholesky factor, in scalars: one is made for every landmark in every
// iteration.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace camloc {

/// Symmetric block of a landmark and its gradient.
struct LandmarkBlock {
  double c00 = 0, c10 = 0, c11 = 0, c20 = 0, c21 = 0, c22 = 0;
  double g[3] = {0, 0, 0};

  void add_isotropic(double weight, const Eigen::Vector3d& residual) {
    c00 += weight;
    c11 += weight;
    c22 += weight;
    for (int i = 0; i < 3; ++i) g[i] += weight * residual[i];
  }
};

/// L^-1 of the damped block C = L L', lower triangle.
struct InverseFactor {
  double l00, l10, l11, l20, l21, l22;

  /// False where the block is singular.
  bool compute(const LandmarkBlock& C, double damping) {
    constexpr double kMinPivot = 1e-13;   // relative: below, the pivot is rounding error
    constexpr double kTraceShare = 1e-3;  // of the damping: holds a direction along an axis that nothing measures
    const double grow = 1.0 + damping, trace = C.c00 + C.c11 + C.c22, shift = damping * kTraceShare * trace;
    const double c00 = grow * C.c00 + shift, c11 = grow * C.c11 + shift, c22 = grow * C.c22 + shift;
    const double floor = kMinPivot * trace;
    if (!(c00 > floor)) return false;
    const double a00 = std::sqrt(c00), a10 = C.c10 / a00, a20 = C.c20 / a00;
    const double d11 = c11 - a10 * a10;
    if (!(d11 > floor)) return false;
    const double a11 = std::sqrt(d11), a21 = (C.c21 - a20 * a10) / a11;
    const double d22 = c22 - a20 * a20 - a21 * a21;
    if (!(d22 > floor)) return false;
    l00 = 1.0 / a00;
    l11 = 1.0 / a11;
    l22 = 1.0 / std::sqrt(d22);
    l10 = -a10 * l00 * l11;
    l21 = -a21 * l11 * l22;
    l20 = -(a20 * l00 + a21 * l10) * l22;
    return true;
  }

  [[nodiscard]] Eigen::Vector3d times(const double g[3]) const {
    return {l00 * g[0], l10 * g[0] + l11 * g[1], l20 * g[0] + l21 * g[1] + l22 * g[2]};
  }
  [[nodiscard]] Eigen::Vector3d transposed_times(const Eigen::Vector3d& y) const {
    return {l00 * y[0] + l10 * y[1] + l20 * y[2], l11 * y[1] + l21 * y[2], l22 * y[2]};
  }
};

}  // namespace camloc
