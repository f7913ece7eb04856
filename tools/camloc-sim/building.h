// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The two buildings the simulator knows.
//
//   building  a closed corridor loop 57 x 40 m, walked counter-clockwise (side 0 along +x, 1 along +y, 2 along -x, 3 along
//             -y), with nine open offices, identical doors, five look-alike stretches of two looks, two blank stretches
//   small     an L of 10 + 8 m corridor and two offices
#pragma once

#include "tools/camloc-sim/floor_plan.h"

namespace camloc::sim {

[[nodiscard]] FloorPlan floor_plan(SceneKind kind);
[[nodiscard]] Placement office_place(const FloorPlan& plan, const Office& office);
/// Builds everything and bakes the light.
[[nodiscard]] Scene build_scene(const FloorPlan& plan, const SceneOptions& options);

}  // namespace camloc::sim
