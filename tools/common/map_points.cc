// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/common/map_points.h"

namespace camloc::tools {

std::vector<Eigen::Vector3d> landmark_positions(const MapView& map, std::uint32_t min_observations) {
  std::vector<Eigen::Vector3d> points;
  points.reserve(map.landmarks().size());
  map.for_each_position([&](const auto& landmark, const Eigen::Vector3f& position_m) {
    if (landmark.num_observations >= min_observations) points.push_back(position_m.cast<double>());
  });
  return points;
}

std::vector<Rigid3> keyframe_poses(const MapView& map) {
  std::vector<Rigid3> poses;
  for (std::uint32_t k = 0; k < map.keyframes().size(); ++k) poses.push_back(map.keyframe_pose(k));
  return poses;
}

}  // namespace camloc::tools
