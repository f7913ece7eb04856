// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Who walks where on which day: the camera's path through a floor plan, and the other people in the building.
#pragma once

#include <cstdint>
#include <vector>

#include "tools/camloc-sim/building.h"
#include "tools/camloc-sim/trajectory.h"

namespace camloc::sim {

/// Day 1 is the mapping walk: the whole loop and most offices, an overlap, then a stretch back in the other direction. Other
/// days start elsewhere, keep to another side of the corridor, and visit other offices.
[[nodiscard]] std::vector<Eigen::Vector2d> walk_path(const FloorPlan& plan, SceneKind kind, std::uint32_t day);
[[nodiscard]] WalkStyle walk_style(SceneKind kind, std::uint32_t day, std::uint32_t seed);

/// Somebody walking along a corridor side at constant speed, passing `meet_s` at `meet_time_s`; speed 0 stands.
struct Passer {
  int side = 0;
  double meet_s = 0, meet_time_s = 0, speed_m_s = 0, n = 1.1;
  double from_time_s = 0, to_time_s = 0;
  std::uint32_t seed = 0;
};

/// Nobody on day 1. Otherwise people come towards the camera, walk ahead of it, or stand about.
[[nodiscard]] std::vector<Passer> plan_passers(const FloorPlan& plan, const Trajectory& trajectory, const SceneOptions& options);
/// Surfaces of everybody around at a time, light baked.
[[nodiscard]] std::vector<Surface> people_at(const FloorPlan& plan, const Scene& scene, const std::vector<Passer>& passers, double time_s);

}  // namespace camloc::sim
