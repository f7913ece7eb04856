// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Landmarks beyond the reach of the depth camera: features without depth that two keyframes see under different angles are
// triangulated. In a bare corridor they are all there is to hold on to.
#pragma once

#include <cstdint>
#include <optional>

#include "core/slam/slam_map.h"
#include "core/slam/slam_numbers.h"

namespace camloc {

/// The point closest to two rays, in the frame of the poses; nothing where it is behind a camera. Rays are (x/z, y/z, 1).
[[nodiscard]] std::optional<Eigen::Vector3d> triangulate(const Rigid3& T_map_a, const Eigen::Vector2d& ray_a, const Rigid3& T_map_b,
                                                         const Eigen::Vector2d& ray_b);

/// Adds landmarks that the keyframe and an earlier one of its segment see without depth. Returns how many.
int add_far_landmarks(const SlamNumbers& numbers, std::uint32_t keyframe, SlamMap* map);

}  // namespace camloc
