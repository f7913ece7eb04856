// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// First-order propagation of pose covariances into the world.
#include "core/geometry/wcs.h"

namespace camloc {

PoseWithCovariance to_wcs(const WcsDatum& datum, const PoseWithCovariance& T_map_camera) {
  // With errors to the left, T_true = (p + dp, exp(dr) R): a turn dr of the datum moves the camera by dr x lever.
  const Eigen::Vector3d lever = datum.T_wcs_map.rotation.toRotationMatrix() * T_map_camera.pose.translation;

  Matrix6d from_datum = Matrix6d::Identity();
  from_datum.topRightCorner<3, 3>() << 0, lever.z(), -lever.y(), -lever.z(), 0, lever.x(), lever.y(), -lever.x(), 0;
  const Matrix6d covariance =
      from_datum * datum.covariance * from_datum.transpose() + rotate_covariance(datum.T_wcs_map.rotation, T_map_camera.covariance);
  return {datum.T_wcs_map * T_map_camera.pose, 0.5 * (covariance + covariance.transpose())};
}

}  // namespace camloc
