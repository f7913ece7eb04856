// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// How far away a landmark is: residual (z - depth) / sigma(depth), along the camera's optical axis r2, which is its derivative by
// the landmark.
#pragma once

#include <array>
#include <cmath>

#include "core/optimize/terms/kernels.h"
#include "core/optimize/terms/observation.h"

namespace camloc {

struct DepthTerm {
  static constexpr int kRows = 1;
  double residual[kRows] = {0}, weight = 0, cost = 0;

  DepthTerm(const BundleOptions& options, const BundleObservation& observation, const SeenLandmark& seen) {
    if (!seen.is_in_view || !is_measured(options, observation)) return;
    const double depth = observation.depth_m, sigma = options.depth_noise.sigma_m(depth);
    residual[0] = seen.p[2] - depth;
    const double information = 1.0 / (sigma * sigma);
    const RobustCost robust = huber(residual[0] * residual[0] * information, options.depth_kernel_sigmas);
    weight = information * robust.weight;
    cost = robust.cost;
  }

  [[nodiscard]] static bool is_measured(const BundleOptions& options, const BundleObservation& observation) {
    return options.use_depth && observation.depth_m > 0.0F && std::isfinite(observation.depth_m);
  }

  [[nodiscard]] static Vector6d by_pose(const SeenLandmark& s) {
    Vector6d J;
    J << 0.0, 0.0, -1.0, -s.p[1], s.p[0], 0.0;
    return J;
  }
  [[nodiscard]] static std::array<double, kRows> by_landmark(int axis, const SeenLandmark& s) { return {s.camera.axes[2][axis]}; }
  [[nodiscard]] static double landmark_scale(const SeenLandmark&) { return 1.0; }
};

}  // namespace camloc
