// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Corridors and offices as numbers: what a scene is built from and what walks are planned on.
// A corridor side has local coordinates (s, n): s along the walk, n from the right-hand (outer) wall to the left.
#pragma once

#include <cstdint>
#include <vector>

#include "tools/camloc-sim/scene.h"

namespace camloc::sim {

inline constexpr double kCorridorWidth = 2.2;  // metres
inline constexpr double kCorridorHeight = 2.7;
inline constexpr double kWallThickness = 0.15;

enum class SceneKind { kBuilding, kSmall };

/// What the walls and floor of a piece of corridor look like. Equal `look` = equal walls, floor, ceiling, posters.
struct Stretch {
  double from_s = 0, to_s = 0;
  std::uint32_t look = 0;
  bool is_blank = false;
};

/// A room behind an open doorway. Its own frame has the door wall on the x axis, the room at y > 0, the doorway at
/// x in [0.9, 1.85].
struct Office {
  int side = 0;
  bool is_outer = true;  ///< right-hand side of the walk
  double from_s = 0;     ///< smaller end of the room along the corridor
  double width = 4.5, depth = 5.0;
  int room = 1;
};

struct CorridorSide {
  Placement place;    ///< x = s, y = n
  double length = 0;  ///< of the outer wall
  std::vector<Stretch> stretches;
};

struct FloorPlan {
  std::vector<CorridorSide> sides;
  std::vector<Office> offices;
  bool is_loop = true;
};

/// What the simulator knows:
///   building  a closed corridor loop, seed 1 57 x 40 m, walked counter-clockwise (side 0 along +x, 1 along +y, 2 along -x, 3 along
///             -y), with nine open offices, identical doors, five look-alike stretches of two looks, two blank stretches; another
///             seed is another building of this kind
///   small     an L of 10 + 8 m corridor and two offices; a seed changes what is in them
[[nodiscard]] FloorPlan floor_plan(SceneKind kind, std::uint32_t seed);
[[nodiscard]] Placement office_place(const FloorPlan& plan, const Office& office);

struct SceneOptions {
  SceneKind kind = SceneKind::kBuilding;
  std::uint32_t seed = 1;
  std::uint32_t day = 1;  ///< 1: the mapping day; other days move the clutter and change the light
};

}  // namespace camloc::sim
