// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// When a place counts as seen before, and how far dead reckoning is trusted meanwhile.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/registration/view_registration.h"

namespace camloc {

struct LoopOptions {
  std::size_t num_retrieved = 100;  ///< places that look alike
  std::size_t num_candidates = 8;   ///< of those that are possible, asked for geometry
  std::size_t num_nearby = 3;       ///< keyframes that should see the same, by their poses
  double nearby_m = 1.5, nearby_rad = 0.7;
  float nearby_radius_px = 30;  ///< search window there
  std::size_t keyframes_per_place = 6;
  std::size_t max_place_landmarks = 3500;
  std::uint32_t max_shared = 20;  ///< a keyframe with more common landmarks is a neighbour, no loop
  PlaceLimits place;
  // How far dead reckoning may be off after walking some way.
  double drift_m = 0.05, drift_per_m = 0.01;
  double drift_rad = 0.03, drift_rad_per_m = 0.0005, drift_rad_per_rad = 0.01;
  int num_confirmations = 3;  ///< keyframes that must agree where the drift does not explain the correction
  // Where tracking was lost, the camera may have moved this far until the next segment began.
  double reach_m = 0.5, reach_m_s = 1.5;
  int num_confirmations_within_reach = 3;  ///< keyframes that must agree to join a segment with the one before it
  int num_confirmations_out_of_reach = 8;  ///< and any other two segments, over at least min_joined_path_m
  double min_joined_path_m = 2.0;
  double view_range_m = 6.0;  ///< how far apart two views of one place may be taken from
  double agreement_m = 0.10, agreement_rad = 0.04;
  double max_chi2 = 60;  ///< of any link of the pose graph, 6 degrees of freedom
};

}  // namespace camloc
