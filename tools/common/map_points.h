// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The landmarks of a map as points, and its keyframes, for pictures and comparisons.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/map/map_view.h"

namespace camloc::tools {

/// In the map's frame and order; without those that were seen fewer times.
[[nodiscard]] inline std::vector<Eigen::Vector3d> landmark_positions(const MapView& map, std::uint32_t min_observations = 0) {
  std::vector<Eigen::Vector3d> points;
  points.reserve(map.landmarks().size());
  map.for_each_position([&](const auto& landmark, const Eigen::Vector3f& position_m) {
    if (landmark.num_observations >= min_observations) points.push_back(position_m.cast<double>());
  });
  return points;
}
/// T_map_camera of each keyframe.
[[nodiscard]] inline std::vector<Rigid3> keyframe_poses(const MapView& map) {
  std::vector<Rigid3> poses;
  for (std::uint32_t k = 0; k < map.keyframes().size(); ++k) poses.push_back(map.keyframe_pose(k));
  return poses;
}

}  // namespace camloc::tools
