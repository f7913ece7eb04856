// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Bundle adjustment on the SLAM map: a window around a keyframe while the recording is processed, everything at the end.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/slam/bundle_adjustment.h"
#include "core/slam/slam_map.h"

namespace camloc {

struct LocalAdjustmentOptions {
  std::size_t num_free_keyframes = 8;
  std::size_t num_fixed_keyframes = 16;
  std::uint32_t min_shared = 15;   ///< landmarks that make a keyframe a neighbour
  int max_iterations = 5;
  double max_pixel_sigmas = 3.0;   ///< sightings farther off afterwards are removed
};

/// How well keyframes and landmarks agree after an adjustment.
struct MapFit {
  std::uint64_t num_sightings = 0, num_removed = 0;
  double median_px = 0, p90_px = 0;              ///< reprojection error, pixels of level 0
  double median_depth_sigmas = 0;                ///< |depth residual|, of the noise that the adjustment was given
  double median_depth_m = 0;
};

/// Adjusts the keyframe, its best neighbours and what they see; other keyframes that see it hold it in place. The first
/// keyframe of the segment never moves.
MapFit adjust_locally(const BundleOptions& bundle, const LocalAdjustmentOptions& options, std::uint32_t keyframe, SlamMap* map);

/// A surveyed point that keyframes see. It is no landmark of the map: nobody finds it by its looks.
struct ControlLandmark {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();   ///< as surveyed, in the frame of the segment
  double sigma_m = 0.01;
  struct Seen {
    std::uint32_t keyframe = 0;
    float x = 0, y = 0;       ///< normalized image coordinates
    float depth_m = 0;        ///< 0 = none
    float sigma_px = 1;
  };
  std::vector<Seen> seen;
};

/// What is known about the keyframes of a map besides their sightings.
struct MapEvidence {
  std::span<const ControlLandmark> controls;
  std::span<const PoseGraphEdge> links;   ///< between keyframes, e.g. by dense alignment
};

/// Adjusts all keyframes of a segment twice, without the worst sightings the second time. Control landmarks hold the map where
/// they were surveyed; with three or more of them the first keyframe moves, too. Links count as much less as they disagree with
/// the map in their median: their covariances know nothing of a depth camera that is bent or not in step with the colour camera.
MapFit adjust_globally(const BundleOptions& bundle, std::uint32_t segment, const MapEvidence& evidence,
                       double max_pixel_sigmas, SlamMap* map, const BundleCallback& on_iteration = {});

}  // namespace camloc
