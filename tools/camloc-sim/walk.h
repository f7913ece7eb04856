// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Who walks where on which day: the camera's path through a floor plan, and the other people in the building.
#pragma once

#include <cstdint>
#include <vector>

#include "tools/camloc-sim/floor_plan.h"
#include "tools/camloc-sim/trajectory.h"

namespace camloc::sim {

/// Somebody walking along a corridor side at constant speed, passing `meet_s` at `meet_time_s`; speed 0 stands.
struct Passer {
  int side = 0;
  double meet_s = 0, meet_time_s = 0, speed_m_s = 0, n = 1.1;
  double from_time_s = 0, to_time_s = 0;
  std::uint32_t seed = 0;
};

/// A scene on one day, the walk through it and the other people. Read-only while frames are made.
struct World {
  SceneOptions options;
  FloorPlan plan;
  Scene scene;
  Trajectory trajectory;
  std::vector<Passer> passers;
};
/// On day 1, the mapping day, the camera walks the whole loop and most offices, an overlap, then a stretch back in the other
/// direction; nobody else is there. On other days it starts elsewhere, keeps to another side of the corridor, and visits other
/// offices; people come towards it, walk ahead of it, or stand about.
[[nodiscard]] World make_world(const SceneOptions& options);

/// Surfaces of everybody around at a time, light baked.
[[nodiscard]] std::vector<Surface> people_at(const World& world, double time_s);

}  // namespace camloc::sim
