// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Bundle adjustment on the SLAM map: a window around a keyframe while the recording is processed, everything at the end.
#pragma once

#include <cstdint>

#include "core/slam/map_extract.h"

namespace camloc {

/// How well keyframes and landmarks agree after an adjustment.
struct MapFit {
  std::uint64_t num_observations = 0;
  double median_px = 0, p90_px = 0;  ///< reprojection error, pixels of level 0
  double median_depth_sigmas = 0;    ///< |depth residual|, of the noise that the adjustment was given
  double median_depth_m = 0;
};

/// Adjusts the keyframe, its best neighbours and what they see; other keyframes that see it hold it in place. The first
/// keyframe of the segment never moves.
MapFit adjust_locally(const BundleOptions& bundle, const SlamNumbers& numbers, std::uint32_t keyframe, SlamMap* map);

/// Adjusts all keyframes of a segment twice, without the worst observations the second time. Control landmarks hold the map where
/// they were surveyed; with three or more of them the first keyframe moves, too.
MapFit adjust_globally(const BundleOptions& bundle, std::uint32_t segment, const MapEvidence& evidence, double max_pixel_sigmas,
                       SlamMap* map, const BundleCallback& on_iteration = {});

}  // namespace camloc
