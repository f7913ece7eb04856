// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A tracked frame becomes part of the map: it sees the landmarks it was tracked with, its other features with depth become
// landmarks, and neighbouring keyframes are asked whether they see these, too. Landmarks beyond the reach of the depth camera are
// triangulated from features that two keyframes see under different angles: in a bare corridor they are all there is to hold on to.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/registration/frame_registration.h"
#include "core/registration/landmark_set.h"
#include "core/slam/slam_map.h"
#include "core/slam/slam_numbers.h"

namespace camloc {

/// Adds the keyframe with its pose and everything it sees; `tracked` may be empty (the first of a segment).
std::uint32_t insert_keyframe(std::uint64_t frame, std::uint32_t segment, const FrameFeatures& view,
                              const std::vector<LandmarkObservation>& tracked, SlamMap* map);

/// Looks for landmarks of `landmarks` in a keyframe, within `radius_px` of their projection and at their depth: observations are
/// added, and a landmark that turns out to be the same point as one of the set becomes that one. Returns how many did.
int fuse_into_keyframe(LandmarkSet* landmarks, std::uint32_t keyframe, float radius_px, PoseSolver* solver, SlamMap* map);

/// Shows the landmarks of a keyframe to its best neighbours.
void fuse_with_neighbours(std::uint32_t keyframe, PoseSolver* solver, SlamMap* map);

/// The point closest to two rays, in the frame of the poses; nothing where it is behind a camera. Rays are (x/z, y/z, 1).
[[nodiscard]] std::optional<Eigen::Vector3d> triangulate(const Rigid3& T_map_a, const Eigen::Vector2d& ray_a, const Rigid3& T_map_b,
                                                         const Eigen::Vector2d& ray_b);

/// Adds landmarks that the keyframe and an earlier one of its segment see without depth. Returns how many.
int add_far_landmarks(const SlamNumbers& numbers, std::uint32_t keyframe, SlamMap* map);

}  // namespace camloc
