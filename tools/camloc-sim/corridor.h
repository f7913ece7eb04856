// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// One side of the corridor: floor, ceiling, lamps, walls with doorways, and what hangs on them.
#pragma once

#include <vector>

#include "tools/camloc-sim/floor_plan.h"

namespace camloc::sim {

struct Doorway {
  double from = 0, to = 0;  ///< along the wall, metres
};
inline constexpr double kDoorwayHeight = 2.1;

/// Upright wall from (x0, y) to (x1, y) of the placement (left to right for its viewer; x1 < x0 is allowed) with doorways
/// given in placement x. One texture runs over all pieces.
void add_wall(Scene* scene, const Placement& place, double x0, double x1, double y, double height, const std::vector<Doorway>& doorways,
              const Skin& skin, int room);

void add_corridor_side(Scene* scene, const FloorPlan& plan, int side, const SceneOptions& options);

}  // namespace camloc::sim
