// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Where a landmark is seen in the image: residuals f (u - x) / sigma_px and f (v - y) / sigma_px of the normalized coordinates.
// With the camera's axes r0, r1, r2 in `map` their derivatives by the landmark are q0 / z and q1 / z, where q0 = r0 - u r2 and
// q1 = r1 - v r2.
#pragma once

#include <array>
#include <cmath>

#include "core/optimize/terms/kernels.h"
#include "core/optimize/terms/observation.h"

namespace camloc {

struct ReprojectionTerm {
  static constexpr int kRows = 2;
  double residual[kRows], weight, cost;

  /// An observation that is out of view costs what it would at 45 degrees, so that no step gains by pushing a landmark behind a
  /// camera.
  ReprojectionTerm(const BundleOptions& options, const BundleObservation& observation, const SeenLandmark& seen)
      : residual{seen.du, seen.dv} {
    const double scale = pixels_to_sigmas(options, observation), information = scale * scale;
    const RobustCost robust = huber(seen.is_in_view ? seen.off * information : information, options.pixel_kernel_sigmas);
    cost = robust.cost;
    weight = seen.is_in_view ? information * robust.weight : 0.0;
  }

  /// An observation without a valid standard deviation is taken as one pixel good.
  [[nodiscard]] static double pixels_to_sigmas(const BundleOptions& options, const BundleObservation& observation) {
    const double sigma = observation.sigma_px;
    return sigma > 0.0 && std::isfinite(sigma) ? options.focal_px / sigma : options.focal_px;
  }

  [[nodiscard]] static Eigen::Matrix<double, 6, kRows> by_pose(const SeenLandmark& s) {
    const double uv = s.u * s.v;
    Eigen::Matrix<double, 6, kRows> J;
    J.col(0) << -s.inverse_z, 0.0, s.u * s.inverse_z, uv, -(1.0 + s.u * s.u), s.v;
    J.col(1) << 0.0, -s.inverse_z, s.v * s.inverse_z, 1.0 + s.v * s.v, -uv, -s.u;
    return J;
  }
  [[nodiscard]] static std::array<double, kRows> by_landmark(int axis, const SeenLandmark& s) {
    const auto& r = s.camera.axes;
    return {r[0][axis] - s.u * r[2][axis], r[1][axis] - s.v * r[2][axis]};
  }
  [[nodiscard]] static double landmark_scale(const SeenLandmark& s) { return s.inverse_z; }
};

}  // namespace camloc
