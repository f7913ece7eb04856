// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A plan as surfaces, furniture and light.
#pragma once

#include <vector>

#include "tools/camloc-sim/floor_plan.h"

namespace camloc::sim {

/// Builds everything and bakes the light.
[[nodiscard]] Scene build_scene(const FloorPlan& plan, const SceneOptions& options);

// corridor.cc and office.cc: the parts of build_scene.

struct Doorway {
  double from = 0, to = 0;  ///< along the wall, metres
};
inline constexpr double kDoorwayHeight = 2.1;

/// Upright wall from (x0, y) to (x1, y) of the placement (left to right for its viewer; x1 < x0 is allowed) with doorways
/// given in placement x. One texture runs over all pieces.
void add_wall(Scene* scene, const Placement& place, double x0, double x1, double y, const std::vector<Doorway>& doorways, const Skin& skin,
              int room);

/// Floor, ceiling, lamps, walls with doorways, and what hangs on them.
void add_corridor_side(Scene* scene, const FloorPlan& plan, int side, const SceneOptions& options);
/// Furnished.
void add_office(Scene* scene, const Placement& place, const Office& office, const SceneOptions& options);

// furniture.cc: things that stand in rooms, each built of boxes and sheets. `place` is the thing's own frame: its front faces -y, its
// back lower edge lies on the x axis unless stated.

/// Random choices of a thing: what never changes, and what another day changes (places of clutter, screens, papers).
struct Seeds {
  std::uint32_t object = 0;
  std::uint32_t day = 0;
};

/// 1.6 x 0.8 m against a wall behind it (y = 0), with screen, keyboard, papers, books, mug.
void add_desk(Scene* scene, const Placement& place, const Seeds& seeds, int room);
/// Shelf full of books, `width_m` wide, 2.05 m high, 0.3 m deep, back at y = 0.
void add_bookshelf(Scene* scene, const Placement& place, double width_m, const Seeds& seeds, int room);
/// Centred on the origin of `place`.
void add_chair(Scene* scene, const Placement& place, const Seeds& seeds, int room);
/// One to three cardboard boxes on top of each other, centred.
void add_box_pile(Scene* scene, const Placement& place, const Seeds& seeds, int room);
void add_cabinet(Scene* scene, const Placement& place, const Seeds& seeds, int room);
/// Radiator on the wall y = 0.
void add_radiator(Scene* scene, const Placement& place, double width_m, int room);
/// Closed door with frame, handle and number plate in the wall y = 0, hinge at x = 0. All doors are alike but for the plate.
void add_closed_door(Scene* scene, const Placement& place, std::uint32_t plate_seed, int room);
/// Poster, sign, board: a sheet `depth_m` thick on the wall y = 0, centred at x = 0.
void add_on_wall(Scene* scene, const Placement& place, double width_m, double height_m, double bottom_z, double depth_m, const Skin& skin,
                 int room);
/// Standing person of 1.6 to 1.9 m, centred, facing -y; `stride` in [-1, 1] moves legs and arms.
void add_person(Scene* scene, const Placement& place, std::uint32_t seed, double stride, int room);

}  // namespace camloc::sim
