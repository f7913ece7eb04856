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
[[nodiscard]] inline PoseWithCovariance to_wcs(const WcsDatum& datum, const PoseWithCovariance& T_map_camera) {
  // With errors to the left, T_true = (p + dp, exp(dr) R): a turn dr of the datum moves the camera by dr x lever.
  const Eigen::Vector3d lever = datum.T_wcs_map.rotation.toRotationMatrix() * T_map_camera.pose.translation;

  Matrix6d from_datum = Matrix6d::Identity();
  from_datum.topRightCorner<3, 3>() << 0, lever.z(), -lever.y(), -lever.z(), 0, lever.x(), lever.y(), -lever.x(), 0;
  const Matrix6d covariance =
      from_datum * datum.covariance * from_datum.transpose() + rotate_covariance(datum.T_wcs_map.rotation, T_map_camera.covariance);
  return {datum.T_wcs_map * T_map_camera.pose, 0.5 * (covariance + covariance.transpose())};
}

}  // namespace camloc
