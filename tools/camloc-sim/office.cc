// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <numbers>

#include "tools/camloc-sim/building.h"
#include "tools/camloc-sim/noise.h"

namespace camloc::sim {
namespace {

constexpr double kPi = std::numbers::pi;

/// Frame of a wall of the room whose things face into it: things stand at y < 0 of the result, x to the viewer's right.
struct RoomWalls {
  Placement door, right, back, left;  ///< as seen on entering
};

RoomWalls walls_of(const Placement& place, const Office& office) {
  return {place.child(office.width, 0, kPi), place.child(office.width, office.depth, -0.5 * kPi), place.child(0, office.depth, 0.0),
          place.child(0, 0, 0.5 * kPi)};
}

void add_shell(Scene* scene, const Placement& place, const Office& office, std::uint32_t seed) {
  const double w = office.width, d = office.depth, h = kCorridorHeight;
  const Skin wall{Material::kPaint, hash32(seed, 1), range(hash32(seed, 2), 0.65F, 0.85F)};
  const Skin floor{Material::kCarpet, hash32(seed, 3), range(hash32(seed, 4), 0.3F, 0.5F)};
  scene->add_floor(place, 0, 0, w, d, 0, floor, office.room);
  scene->add_ceiling(place, 0, 0, w, d, h, {Material::kCeiling, hash32(seed, 5), 0.83F}, office.room);
  add_wall(scene, place, w, 0, 0, {{0.9, 1.85}}, wall, office.room);
  scene->add_upright(place, 0, 0, 0, d, 0, h, wall, office.room);
  scene->add_upright(place, 0, d, w, d, 0, h, {Material::kPaint, hash32(seed, 6), 0.78F}, office.room);
  scene->add_upright(place, w, d, w, 0, 0, h, wall, office.room);
}

void add_lights(Scene* scene, const Placement& place, const Office& office) {
  for (const double x : {0.3, 0.7}) {
    const double cx = x * office.width, cy = 0.5 * office.depth, z = kCorridorHeight;
    const Skin body{Material::kPlain, 21, 0.7F};
    scene->add_box(place, {cx - 0.15, cy - 0.6, z - 0.05, cx + 0.15, cy + 0.6, z}, body, body, office.room, true);
    scene->surfaces.back().skin = {Material::kLamp, 22, 1.0F};  // the box's bottom, added last
    scene->lamps.push_back({place.point(cx, cy, z - 0.08), 1.4, office.room, false});
  }
  scene->lamps.push_back({place.point(0.5 * office.width, office.depth - 0.1, 1.6), 1.2, office.room, true});
}

void add_back_wall(Scene* scene, const RoomWalls& walls, const Office& office, const SceneOptions& options, std::uint32_t seed) {
  const double middle = 0.5 * office.width;
  const float sky = options.day == 1 ? 0.85F : 1.05F;
  add_on_wall(scene, walls.back.child(middle, 0, 0), 1.9, 1.25, 1.0, 0.03, {Material::kWindow, hash32(seed, 20), sky}, office.room);
  add_radiator(scene, walls.back.child(middle - 0.8, 0, 0), 1.6, office.room);
  add_cabinet(scene, walls.back.child(office.width - 0.95, 0, 0), {hash32(seed, 21), options.day}, office.room);
}

void add_side_walls(Scene* scene, const RoomWalls& walls, const Office& office, const SceneOptions& options, std::uint32_t seed) {
  // Left on entering: a desk and what hangs above it. x of the left wall's frame runs from the door to the window.
  add_desk(scene, walls.left.child(1.9, 0, 0), {hash32(seed, 30), options.day}, office.room);
  add_on_wall(scene, walls.left.child(2.5, 0, 0), 0.7, 0.95, 1.35, 0.012, {Material::kPoster, hash32(seed, 31)}, office.room);
  add_on_wall(scene, walls.left.child(1.2, 0, 0), 0.9, 0.7, 1.1, 0.02, {Material::kPinboard, hash32(seed, 32)}, office.room);
  add_on_wall(scene, walls.left.child(3.5, 0, 0), 0.45, 0.6, 1.3, 0.012, {Material::kPoster, hash32(seed, 33)}, office.room);
  // Right: bookshelf, desk. x of the right wall's frame runs from the window to the door.
  add_bookshelf(scene, walls.right.child(office.depth - 1.7, 0, 0), 1.5, {hash32(seed, 34), options.day}, office.room);
  add_desk(scene, walls.right.child(office.depth - 3.6, 0, 0), {hash32(seed, 35), options.day}, office.room);
  add_on_wall(scene, walls.right.child(office.depth - 2.8, 0, 0), 1.4, 0.9, 1.25, 0.02,
              {Material::kWhiteboard, hash32(seed, options.day, 36)}, office.room);
  // Beside the door.
  add_on_wall(scene, walls.door.child(office.width - 2.5, 0, 0), 0.6, 0.85, 1.15, 0.012, {Material::kPoster, hash32(seed, 37)},
              office.room);
  add_on_wall(scene, walls.door.child(office.width - 2.05, 0, 0), 0.08, 0.08, 1.1, 0.01, {Material::kSign, 38, 0.95F}, office.room);
  add_on_wall(scene, walls.door.child(office.width - 3.4, 0, 0), 0.8, 0.6, 1.2, 0.012, {Material::kPoster, hash32(seed, 39)}, office.room);
}

/// What people move around from day to day.
void add_clutter(Scene* scene, const Placement& place, const Office& office, const SceneOptions& options, std::uint32_t seed) {
  const auto jitter = [&](std::uint32_t id, float metres) {
    return static_cast<double>(range(hash32(seed, options.day, id), -metres, metres));
  };
  const double w = office.width, d = office.depth;
  add_chair(scene, place.child(0.95 + jitter(1, 0.12F), 2.55 + jitter(2, 0.35F), 1.4 + jitter(3, 0.8F)), {hash32(seed, 50), options.day},
            office.room);
  add_chair(scene, place.child(w - 1.05 + jitter(4, 0.12F), 2.9 + jitter(5, 0.3F), -1.5 + jitter(6, 0.8F)), {hash32(seed, 51), options.day},
            office.room);
  const bool is_moved = options.day != 1;
  add_box_pile(scene, is_moved ? place.child(0.4, 0.4 + jitter(7, 0.1F), 0.3) : place.child(0.45, d - 0.5, 0.1),
               {hash32(seed, 52), options.day}, office.room);
  add_box_pile(scene, place.child(w - 0.45 - 0.1 * jitter(8, 1.0F), 0.4, jitter(9, 0.4F)),
               {hash32(seed, is_moved ? 55U : 53U), options.day}, office.room);
}

}  // namespace

void add_office(Scene* scene, const Placement& place, const Office& office, const SceneOptions& options) {
  const std::uint32_t seed = hash32(options.seed, static_cast<std::uint32_t>(office.room), 500);
  const RoomWalls walls = walls_of(place, office);
  add_shell(scene, place, office, seed);
  add_lights(scene, place, office);
  add_back_wall(scene, walls, office, options, seed);
  add_side_walls(scene, walls, office, options, seed);
  add_clutter(scene, place, office, options, seed);
}

}  // namespace camloc::sim
