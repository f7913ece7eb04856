// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// From the map to the world coordinate system of the site: T_wcs_camera = T_wcs_map * T_map_camera, with the
// uncertainty of both. The camera position of eq. 4 in "Camera localization for augmented reality and indoor
// positioning" (2019), -R^-1 T for a world-to-camera pose, is the translation of T_map_camera.
#pragma once

#include "core/geometry/rigid3.h"

namespace camloc {

/// Where the map lies in the world, with the covariance of pose_error() in the axes of `wcs`.
struct WcsDatum {
  Rigid3 T_wcs_map;
  Matrix6d covariance = Matrix6d::Zero();
};

struct PoseWithCovariance {
  Rigid3 pose;
  Matrix6d covariance = Matrix6d::Zero();
};

/// First-order propagation of both covariances; the lever arm of the datum's rotation error is the camera position.
[[nodiscard]] PoseWithCovariance to_wcs(const WcsDatum& datum, const PoseWithCovariance& T_map_camera);

}  // namespace camloc
