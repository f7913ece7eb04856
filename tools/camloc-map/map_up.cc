// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/camloc-map/map_up.h"

#include <algorithm>

namespace camloc::map_tool {
namespace {

double extent_along(int axis, const std::vector<Eigen::Vector3d>& landmarks, const MapView& map) {
  std::vector<double> values;
  for (const Eigen::Vector3d& p : landmarks) values.push_back(p[axis]);
  std::sort(values.begin(), values.end());
  const std::size_t tail = values.size() / 100;
  double low = values.empty() ? 0 : values[tail], high = values.empty() ? 0 : values[values.size() - 1 - tail];
  for (std::uint32_t k = 0; k < map.keyframes().size(); ++k) {
    const double value = map.keyframe_pose(k).translation[axis];
    low = std::min(low, value);
    high = std::max(high, value);
  }
  return high - low;
}

}  // namespace

std::vector<Eigen::Vector3d> landmark_positions(const MapView& map) {
  std::vector<Eigen::Vector3d> points;
  points.reserve(map.landmarks().size());
  for (const auto& submap : map.submaps()) {
    for (const auto& landmark : map.landmarks().subspan(submap.first_landmark, submap.num_landmarks)) {
      points.push_back(MapView::position_m(submap, landmark).cast<double>());
    }
  }
  return points;
}

Eigen::Vector3d up_axis(const MapView& map) {
  if (map.info().wcs) return map.info().wcs->T_wcs_map.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  const std::vector<Eigen::Vector3d> landmarks = landmark_positions(map);
  int flat = 0;
  double smallest = extent_along(0, landmarks, map);
  for (int axis = 1; axis < 3; ++axis) {
    if (const double extent = extent_along(axis, landmarks, map); extent < smallest) {
      smallest = extent;
      flat = axis;
    }
  }
  double image_top = 0;
  for (std::uint32_t k = 0; k < map.keyframes().size(); ++k) image_top -= (map.keyframe_pose(k).rotation * Eigen::Vector3d::UnitY())[flat];
  return (image_top < 0 ? -1.0 : 1.0) * Eigen::Vector3d::Unit(flat);
}

}  // namespace camloc::map_tool
