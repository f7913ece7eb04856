// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Derivatives of what a camera sees by a small change of its pose, shared by the robust loop and the refinement.
//
// A change (position step a, rotation vector b), both in the axes of the *camera*, moves the camera to
//   translation + R_map_camera * a,   R_map_camera * exp(b) = exp(R_map_camera * b) * R_map_camera,
// so turning both halves by R_map_camera gives the left perturbation in the axes of `map` that pose_error() is about.
// A point p in the camera then moves by  -a + p x b.
#pragma once

#include "core/geometry/rigid3.h"

namespace camloc {

/// Rows of the derivative of (u, v) = (x/z, y/z) and of z, for a point with normalized coordinates (u, v) and depth z.
struct PointJacobian {
  Vector6d u, v, z;
};

[[nodiscard]] inline PointJacobian point_jacobian(double u, double v, double z) {
  const double inverse_z = 1.0 / z;
  PointJacobian J;
  J.u << -inverse_z, 0.0, u * inverse_z, u * v, -(1.0 + u * u), v;
  J.v << 0.0, -inverse_z, v * inverse_z, 1.0 + v * v, -u * v, -u;
  J.z << 0.0, 0.0, -1.0, -v * z, u * z, 0.0;
  return J;
}

/// The pose after a change in camera axes.
[[nodiscard]] inline Rigid3 moved_in_camera_axes(const Rigid3& T_map_camera, const Vector6d& change) {
  return {(T_map_camera.rotation * exp_so3(change.tail<3>())).normalized(),
          T_map_camera.translation + T_map_camera.rotation * change.head<3>()};
}

}  // namespace camloc
