// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Inside of bundle_adjustment.cc: one observation of one landmark, its residuals, robust weights and derivatives. Called for
// every observation in every iteration, hence inline and in scalars.
//
// A point p in the camera has u = x/z, v = y/z. Its residuals are f (u - x) / sigma_px, f (v - y) / sigma_px and
// (z - depth) / sigma_depth. With the axes r0, r1, r2 of the camera in `map` (columns of R_map_camera), the derivatives by the
// landmark are  du = q0/z, dv = q1/z, dz = r2  with q0 = r0 - u r2, q1 = r1 - v r2;  those by the pose are in
// pose_jacobian.h.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/geometry/rigid3.h"
#include "core/optimize/bundle_adjustment.h"

namespace camloc {

/// Landmarks nearer than this, or behind the camera, take no part.
inline constexpr double kMinBundleDepth_m = 0.05;
inline constexpr std::uint32_t kFixedCamera = 0xffffffff;

/// A camera as the loops read it.
struct BundleCamera {
  double axes[3][3];  ///< r0, r1, r2: axes of the camera in `map`
  double centre[3];
  std::uint32_t free_index;  ///< row in the reduced system, or kFixedCamera

  BundleCamera(const Rigid3& T_map_camera, std::uint32_t index) : free_index(index) {
    const Eigen::Matrix3d R = T_map_camera.rotation.toRotationMatrix();
    for (int k = 0; k < 3; ++k) {
      for (int i = 0; i < 3; ++i) axes[k][i] = R(i, k);
      centre[k] = T_map_camera.translation[k];
    }
  }
};

/// The options in the form the loops need.
struct BundleModel {
  double focal_px, depth_constant_m, depth_quadratic_per_m;
  double pixel_kernel, depth_kernel;  ///< widths in sigmas
  bool use_depth;

  explicit BundleModel(const BundleOptions& o)
      : focal_px(o.focal_px),
        depth_constant_m(o.depth_noise.constant_m),
        depth_quadratic_per_m(o.depth_noise.quadratic_per_m),
        pixel_kernel(o.pixel_kernel_sigmas),
        depth_kernel(o.depth_kernel_sigmas),
        use_depth(o.use_depth) {}
};

/// Huber's kernel of a squared residual (Huber, "Robust estimation of a location parameter", 1964): cost, and weight in
/// iteratively reweighted least squares.
inline double huber(double squared, double width, double* weight) {
  const double inner = width * width;
  if (squared <= inner) return squared;
  const double length = std::sqrt(squared);
  *weight *= width / length;
  return 2.0 * width * length - inner;
}

/// What an observation adds to the equations. Weights are 0 where a part takes no part.
struct BundleTerms {
  double p[3];  ///< landmark in the camera
  double u, v, inverse_z;
  double du, dv, dz;    ///< predicted minus measured: normalized coordinates, metres
  double pixel_weight;  ///< robust weight * (f / sigma_px)^2
  double depth_weight;  ///< robust weight / sigma_depth^2
  double cost;
};

[[nodiscard]] inline bool has_depth(const BundleModel& model, const BundleObservation& observation) {
  return model.use_depth && observation.depth_m > 0.0F && std::isfinite(observation.depth_m);
}

/// An observation without a valid standard deviation is taken as one pixel good.
[[nodiscard]] inline double pixels_to_sigmas(const BundleModel& model, const BundleObservation& observation) {
  const double sigma = observation.sigma_px;
  return sigma > 0.0 && std::isfinite(sigma) ? model.focal_px / sigma : model.focal_px;
}

[[nodiscard]] inline double depth_sigma_m(const BundleModel& model, double depth_m) {
  return model.depth_constant_m + model.depth_quadratic_per_m * depth_m * depth_m;
}

/// An observation of a landmark that lies behind the camera, is more than 45 degrees off, or is not finite is left out: weights
/// 0, and the cost it would have at 45 degrees, so that no step gains by pushing a landmark behind a camera.
[[nodiscard]] inline BundleTerms bundle_terms(const BundleModel& model, const BundleObservation& observation, const BundleCamera& camera,
                                              const double X[3]) {
  BundleTerms t;
  const double d0 = X[0] - camera.centre[0], d1 = X[1] - camera.centre[1], d2 = X[2] - camera.centre[2];
  for (int k = 0; k < 3; ++k) t.p[k] = camera.axes[k][0] * d0 + camera.axes[k][1] * d1 + camera.axes[k][2] * d2;
  const double scale = pixels_to_sigmas(model, observation);
  t.inverse_z = 1.0 / t.p[2];
  t.u = t.p[0] * t.inverse_z;
  t.v = t.p[1] * t.inverse_z;
  t.du = t.u - static_cast<double>(observation.x);
  t.dv = t.v - static_cast<double>(observation.y);
  const double off = t.du * t.du + t.dv * t.dv;
  t.pixel_weight = scale * scale;
  t.depth_weight = 0;
  t.dz = 0;
  if (!(t.p[2] > kMinBundleDepth_m && off < 1.0)) {
    t.cost = huber(t.pixel_weight, model.pixel_kernel, &t.pixel_weight);
    t.pixel_weight = 0;
    return t;
  }
  t.cost = huber(off * t.pixel_weight, model.pixel_kernel, &t.pixel_weight);
  if (has_depth(model, observation)) {
    const double depth = observation.depth_m, sigma = depth_sigma_m(model, depth);
    t.dz = t.p[2] - depth;
    t.depth_weight = 1.0 / (sigma * sigma);
    t.cost += huber(t.dz * t.dz * t.depth_weight, model.depth_kernel, &t.depth_weight);
  }
  return t;
}

}  // namespace camloc
