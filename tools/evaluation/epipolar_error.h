// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Poses against the images themselves: how far matched features of two images lie from each other's epipolar lines. Needs no
// reference, and so tells whether a trajectory or its reference is to blame when the two disagree.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/features/matcher.h"
#include "core/geometry/camera.h"
#include "core/geometry/pnp_ransac.h"
#include "core/registration/frame_features.h"

namespace camloc::tools {

struct EpipolarError {
  int num_matches = 0;   ///< that one rigid motion explains
  double median_px = 0;  ///< Sampson distance under the given poses
};

/// Measures pairs of frames. Not thread-safe.
class EpipolarMeter {
 public:
  EpipolarMeter(const Intrinsics& color, const OrbOptions& orb);

  /// Which matches are right is decided by the images and the depth of `a` alone (P3P and RANSAC), so that the given poses
  /// (T_map_camera of both frames) are judged, never used. Nothing where the frames share too little.
  [[nodiscard]] std::optional<EpipolarError> measure(const FrameFeatures& a, const FrameFeatures& b);

 private:
  double focal_px_;
  CandidateSet candidates_;
  CandidateMatcher matcher_;
  Correspondences pairs_;
  PnpRansac ransac_;
};

/// First-order distance of a match from the epipolar constraint (Sampson, "Fitting conic sections to 'very scattered' data", 1982;
/// Hartley and Zisserman, "Multiple View Geometry", 2004, section 11.4.3), in normalized image coordinates.
[[nodiscard]] double sampson_distance(const Rigid3& T_b_a, const Eigen::Vector2d& a, const Eigen::Vector2d& b);

/// For a frame at `T_map_camera`, the `count` of the `others` that look from the most similar place in the most similar direction
/// (a turn by one radian counts like two metres), nearest first. Frames that are `is_excluded` are passed over.
[[nodiscard]] std::vector<std::size_t> most_similar_views(const Rigid3& T_map_camera, const std::vector<Rigid3>& others,
                                                          const std::vector<bool>& is_excluded, std::size_t count);

}  // namespace camloc::tools
