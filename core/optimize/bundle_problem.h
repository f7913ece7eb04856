// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What a bundle adjustment is given: cameras, landmarks, who saw what, and what else is known about them.
#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "core/optimize/terms/point_prior.h"
#include "core/optimize/terms/relative_pose.h"

namespace camloc {

/// A landmark as one camera saw it.
struct BundleObservation {
  std::uint32_t camera = 0, landmark = 0;
  float x = 0, y = 0;  ///< normalized image coordinates, undistorted
  float depth_m = 0;   ///< measured along the optical axis, 0 = none
  float sigma_px = 1;  ///< standard deviation of the feature position, pixels of level 0
};

struct BundleProblem {
  std::vector<Rigid3> T_map_camera;
  std::vector<std::uint8_t> is_camera_fixed;    ///< as many as cameras
  std::vector<Eigen::Vector3d> landmarks_m;     ///< in `map`
  std::vector<BundleObservation> observations;  ///< ordered by landmark
  std::vector<PointPrior> priors;
  std::vector<PoseGraphEdge> links;               ///< between two cameras, measured otherwise than by landmarks
  std::vector<const PoseTerms*> pose_terms = {};  ///< what else is known of cameras; not owned
};

struct BundleOptions {
  double focal_px = 525;
  DepthNoise depth_noise;
  bool use_depth = true;              ///< false: reprojection errors only, for comparison
  double pixel_kernel_sigmas = 2.45;  ///< width of the Huber kernel over |pixel residual| / sigma
  double depth_kernel_sigmas = 2.0;   ///< and over the depth residual
  int max_iterations = 20;
  double min_relative_decrease = 1e-5;    ///< of the cost, below which the adjustment has converged
  std::uint32_t max_dense_cameras = 250;  ///< free cameras up to which the reduced system is dense
};

}  // namespace camloc
