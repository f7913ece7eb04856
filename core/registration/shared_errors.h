// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What a pose is off because landmarks that lie together are off together. A landmark inherits the error of the views that it was
// mapped from, so the landmarks of one part of the image move as one, and more of them there do not average it out. Normal equations
// that take every pair as an observation of its own do not know that: where few parts of the image hold inliers, or where a turn looks
// nearly like a step, they promise too much. The sandwich of Liang and Zeger, "Longitudinal data analysis using generalized linear
// models", 1986, with the shared part taken from what the map says about its views, not from residuals: the pose has absorbed most of it.
#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/correspondences.h"
#include "core/geometry/rigid3.h"

namespace camloc {

/// Standard deviations, each axis, of the views that landmarks were mapped from. A turn moves a landmark by its distance times the angle.
struct SharedErrors {
  double sigma_m = 0, sigma_rad = 0;
};

struct SharedErrorsModel {
  double focal_px = 1;
  DepthNoise depth_noise;
  bool use_depth = true;
  SharedErrors landmarks;
};

/// The covariance of pose_error() (metres, radians, axes of `map`) that shared errors of the landmarks add to the pose refined on the
/// pairs that `inlier_mask` (a byte a pair) marks: H^-1 (sum over parts of the image of B B') H^-1, where H is the Gauss-Newton matrix
/// and B the derivative of its gradient by the common error of a part. A part is a square of 0.3 in normalized coordinates, 17 degrees:
/// smaller ones leave too much independent (kitchen, second half to first: 85 % inside the 95 % ellipsoid with half of that). Zero
/// without shared errors and where the pairs do not fix a pose. Allocates nothing.
[[nodiscard]] Matrix6d shared_error_covariance(const Correspondences& pairs, const std::vector<std::uint8_t>& inlier_mask,
                                               const Rigid3& T_map_camera, const SharedErrorsModel& model);

}  // namespace camloc
