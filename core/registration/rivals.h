// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Two poses of one view are rivals when they are too far apart to be the same place: then at most one of them is right.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/rigid3.h"
#include "core/registration/feature_set.h"
#include "core/registration/pose_evidence.h"

namespace camloc {

struct RivalDistance {
  double position_m = 0.25;
  double rotation_rad = 0.2;
};

[[nodiscard]] inline bool are_rivals(const Rigid3& T_map_a, const Rigid3& T_map_b, const RivalDistance& apart) {
  return (T_map_a.translation - T_map_b.translation).norm() >= apart.position_m ||
         rotation_distance_rad(T_map_a.rotation, T_map_b.rotation) >= apart.rotation_rad;
}

/// A pose for a frame and which of its features it explains.
struct Hypothesis : PoseEvidence {
  FeatureSet explained;
  FeatureSet distinct;         ///< of those by landmarks that are nowhere else
  bool is_look_alike = false;  ///< the map says that another pose that was found would see nearly the same
};

/// How a pose stands against the others that were found for the same frame.
struct Standing {
  double margin = 1;                                      ///< see margin_of()
  double lead = std::numeric_limits<double>::infinity();  ///< see lead_of()
};

/// By how many standard deviations the features that only `best` explains outnumber those that only its nearest rival explains. What
/// both explain says nothing, and neither does what repeats itself: there may be more of it in the map at one place than at the other.
/// Infinite without one that is a look-alike.
template <typename Hypotheses>
[[nodiscard]] double lead_of(const Hypotheses& hypotheses, const Hypothesis& best, const RivalDistance& apart) {
  double lead = std::numeric_limits<double>::infinity();
  for (const Hypothesis& other : hypotheses) {
    if (!other.is_found || !other.is_look_alike || !are_rivals(other.T_map_camera, best.T_map_camera, apart)) continue;
    const auto ours = static_cast<double>(best.distinct.count_without(other.explained));
    const auto theirs = static_cast<double>(other.distinct.count_without(best.explained));
    lead = std::min(lead, (ours - theirs) / std::sqrt(ours + theirs + 1));
  }
  return lead;
}

/// 1 - inliers of the strongest rival / inliers of the best one: 1 without a rival, 0 where one explains the view as well. Look-alikes
/// that the map knows are judged by lead_of().
template <typename Candidates>
[[nodiscard]] double margin_of(const Candidates& candidates, const typename Candidates::value_type& best, const RivalDistance& apart) {
  if (!best.is_found || best.num_inliers == 0) return 0.0;
  std::uint32_t rival_inliers = 0;
  for (const auto& other : candidates) {
    if (other.is_found && !other.is_look_alike && other.num_inliers > rival_inliers &&
        are_rivals(other.T_map_camera, best.T_map_camera, apart))
      rival_inliers = other.num_inliers;
  }
  return 1.0 - static_cast<double>(rival_inliers) / best.num_inliers;
}

}  // namespace camloc
