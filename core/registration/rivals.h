// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Two poses of one view are rivals when they are too far apart to be the same place: then at most one of them is right.
#pragma once

#include "core/geometry/rigid3.h"

namespace camloc {

struct RivalDistance {
  double position_m = 0.25;
  double rotation_rad = 0.2;
};

[[nodiscard]] inline bool are_rivals(const Rigid3& T_map_a, const Rigid3& T_map_b, const RivalDistance& apart) {
  return (T_map_a.translation - T_map_b.translation).norm() >= apart.position_m ||
         rotation_distance_rad(T_map_a.rotation, T_map_b.rotation) >= apart.rotation_rad;
}

/// 1 - inliers of the strongest rival / inliers of the best one: 1 without a rival, 0 where one explains the view as well.
template <typename Candidates>
[[nodiscard]] double margin_of(const Candidates& candidates, const typename Candidates::value_type& best, const RivalDistance& apart) {
  if (!best.is_found || best.num_inliers == 0) return 0.0;
  std::uint32_t rival_inliers = 0;
  for (const auto& other : candidates) {
    if (other.is_found && other.num_inliers > rival_inliers && are_rivals(other.T_map_camera, best.T_map_camera, apart))
      rival_inliers = other.num_inliers;
  }
  return 1.0 - static_cast<double>(rival_inliers) / best.num_inliers;
}

}  // namespace camloc
