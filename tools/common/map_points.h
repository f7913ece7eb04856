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
[[nodiscard]] std::vector<Eigen::Vector3d> landmark_positions(const MapView& map, std::uint32_t min_observations = 0);
/// T_map_camera of each keyframe.
[[nodiscard]] std::vector<Rigid3> keyframe_poses(const MapView& map);

}  // namespace camloc::tools
