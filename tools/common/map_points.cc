// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/common/map_points.h"

namespace camloc::tools {

std::vector<Eigen::Vector3d> landmark_positions(const MapView& map, std::uint32_t min_observations) {
  std::vector<Eigen::Vector3d> points;
  points.reserve(map.landmarks().size());
  for (const auto& cube : map.cubes()) {
    for (const auto& landmark : map.landmarks().subspan(cube.first_landmark, cube.num_landmarks)) {
      if (landmark.num_observations >= min_observations) points.push_back(MapView::position_m(cube, landmark).cast<double>());
    }
  }
  return points;
}

}  // namespace camloc::tools
