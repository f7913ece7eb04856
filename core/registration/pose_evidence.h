// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A pose and all that speaks for it and against it. Made by PoseSolver, never changed after; verification decides what it is worth.
#pragma once

#include <cstdint>

#include "core/geometry/rigid3.h"

namespace camloc {

struct PoseEvidence {
  bool is_found = false;
  Rigid3 T_map_camera;
  Matrix6d covariance = Matrix6d::Zero();         ///< of pose_error(): metres, radians, axes of `map`; inliers err by themselves
  Matrix6d shared_covariance = Matrix6d::Zero();  ///< to be added: what inliers share, see shared_error_covariance()
  std::uint32_t num_visible = 0;                  ///< landmarks that should be in the image, as far as they were projected
  std::uint32_t num_matches = 0;                  ///< of those, found in their window; before guided refinement all that were given
  std::uint32_t num_inliers = 0;
  std::uint32_t num_distinct_visible = 0, num_distinct_inliers = 0;  ///< the same without landmarks that have twins elsewhere
  double spread = 0;                                                 ///< share of the image's 8 x 6 cells that hold an inlier
  double thickness_m = 1;  ///< standard deviation of the inliers' landmarks about the plane that fits them best
  std::uint32_t num_with_depth = 0;
  double depth_agreement = 1;       ///< share of inliers with depth whose depth agrees
  std::uint32_t num_map_depth = 0;  ///< landmarks in view whose pixel has a measured depth and that nothing hides
  double map_depth_agreement = 1;   ///< share of those that lie on the measured surface; the others are seen through
  double rms_px = 0, median_px = 0;
  double focal_scale = 1;  ///< true / assumed focal length that fits these matches best
  double focal_scale_sigma = 1;
  bool has_focal_scale = false;

  /// Of the landmarks that should be seen and are nowhere else, how many are; 1 where that is not known.
  [[nodiscard]] double found_share() const {
    return num_distinct_visible == 0 ? 1.0 : static_cast<double>(num_distinct_inliers) / num_distinct_visible;
  }
  [[nodiscard]] double inlier_ratio() const { return num_matches == 0 ? 0.0 : static_cast<double>(num_inliers) / num_matches; }
};

}  // namespace camloc
