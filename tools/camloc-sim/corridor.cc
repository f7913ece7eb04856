// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tools/camloc-sim/building.h"
#include "tools/camloc-sim/noise.h"

namespace camloc::sim {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kCorridorRoom = 0;

/// Where the doors of the offices of one wall are, in s.
std::vector<Doorway> doorways_of(const FloorPlan& plan, int side, bool is_outer) {
  std::vector<Doorway> result;
  for (const Office& office : plan.offices) {
    if (office.side != side || office.is_outer != is_outer) continue;
    const double near = 0.9, far = 1.85;  // office frame; an outer office's x runs against s
    if (is_outer)
      result.push_back({office.from_s + office.width - far, office.from_s + office.width - near});
    else
      result.push_back({office.from_s + near, office.from_s + far});
  }
  std::sort(result.begin(), result.end(), [](const Doorway& a, const Doorway& b) { return a.from < b.from; });
  return result;
}

Skin wall_skin(const Stretch& stretch) {
  const std::uint32_t seed = hash32(stretch.look, 100);
  if (stretch.is_blank) return {Material::kBlank, seed, 0.72F};
  if (stretch.look % 10U == 1U) return {Material::kBrick, seed, 0.45F};
  return {Material::kPaint, seed, range(hash32(seed, 1), 0.62F, 0.82F)};
}

Skin floor_skin(const Stretch& stretch) {
  const std::uint32_t seed = hash32(stretch.look, 101);
  if (stretch.is_blank) return {Material::kLinoleum, seed, 0.45F};
  const Material material = stretch.look % 3U == 0U ? Material::kCarpet : Material::kTiles;
  return {material, seed, range(hash32(seed, 1), 0.35F, 0.55F)};
}

/// The reveal of a doorway through the wall, seen when passing.
void add_reveal(Scene* scene, const Placement& place, const Doorway& door, double y0, double y1) {
  const Skin skin{Material::kPlain, 17, 0.5F};
  scene->add_upright(place, door.from, y0, door.from, y1, 0, kDoorwayHeight, skin, kCorridorRoom);
  scene->add_upright(place, door.to, y1, door.to, y0, 0, kDoorwayHeight, skin, kCorridorRoom);
  scene->add_ceiling(place, door.from, y0, door.to, y1, kDoorwayHeight, skin, kCorridorRoom);
  scene->add_floor(place, door.from, y0, door.to, y1, 0, skin, kCorridorRoom);
}

/// Frame of a wall: x to the right for its viewer, the wall on the x axis, its viewer at y < 0; x = 0 at `s`.
Placement wall_place(const CorridorSide& side, bool is_outer, double s) {
  return is_outer ? side.place.child(s, 0.0, kPi) : side.place.child(s, kCorridorWidth, 0.0);
}

bool is_free(const std::vector<Doorway>& doorways, double s, double half_width) {
  return std::none_of(doorways.begin(), doorways.end(),
                      [&](const Doorway& d) { return s + half_width > d.from - 0.25 && s - half_width < d.to + 0.25; });
}

/// One thing on the wall around s, chosen by the stretch's look and the slot: the same in look-alike stretches.
void decorate_slot(Scene* scene, const CorridorSide& side, bool is_outer, const Stretch& stretch, int slot, double s,
                   std::uint32_t unique) {
  const std::uint32_t h = hash32(stretch.look, is_outer ? 1U : 2U, static_cast<std::uint32_t>(slot));
  const Placement at = wall_place(side, is_outer, s);
  switch (h % 8U) {
    case 0:
    case 1:
    case 2: add_closed_door(scene, at.child(-0.6, 0, 0), unique, kCorridorRoom); break;
    case 3:
    case 4: {
      const double width = range(hash32(h, 1), 0.5F, 0.95F);
      add_on_wall(scene, at, width, 1.4 * width, range(hash32(h, 2), 0.75F, 1.15F), 0.012, {Material::kPoster, hash32(h, 3)},
                  kCorridorRoom);
      break;
    }
    case 5: add_on_wall(scene, at, 1.4, 0.95, 0.95, 0.02, {Material::kPinboard, hash32(h, 4)}, kCorridorRoom); break;
    case 6:
      add_radiator(scene, at.child(-0.6, 0, 0), 1.2, kCorridorRoom);
      add_on_wall(scene, at, 0.42, 0.3, 1.4, 0.012, {Material::kPoster, hash32(h, 5)}, kCorridorRoom);
      break;
    default:
      add_on_wall(scene, at, 0.24, 0.55, 0.9, 0.14, {Material::kSign, hash32(h, 6), 0.3F},
                  kCorridorRoom);  // fire extinguisher cupboard
      add_on_wall(scene, at, 0.21, 0.297, 1.5, 0.003, {Material::kPaper, hash32(h, 7)}, kCorridorRoom);
      break;
  }
}

void decorate_wall(Scene* scene, const FloorPlan& plan, int side_index, bool is_outer, const SceneOptions& options) {
  const CorridorSide& side = plan.sides[static_cast<std::size_t>(side_index)];
  const std::vector<Doorway> doorways = doorways_of(plan, side_index, is_outer);
  constexpr double kSlot = 2.0;
  for (const Stretch& stretch : side.stretches) {
    if (stretch.is_blank) continue;
    const int num_slots = static_cast<int>((stretch.to_s - stretch.from_s) / kSlot);
    for (int slot = 0; slot < num_slots; ++slot) {
      const double s = stretch.from_s + (slot + 0.5) * kSlot;
      const bool is_inner_corner = !is_outer && (s < kCorridorWidth + 0.75 || s > side.length - kCorridorWidth - 0.75);
      if (is_inner_corner || !is_free(doorways, s, 0.95)) continue;
      const std::uint32_t unique = hash32(options.seed, static_cast<std::uint32_t>(side_index * 1000 + slot * 2 + (is_outer ? 1 : 0)),
                                          static_cast<std::uint32_t>(stretch.from_s * 10));
      decorate_slot(scene, side, is_outer, stretch, slot, s, unique);
    }
    // What tells look-alike stretches apart for the attentive: one sheet of paper each, and the door plates.
    const double s = stretch.from_s + 2.0;
    if (is_outer && stretch.to_s - stretch.from_s > 5.0 && is_free(doorways, s, 0.2)) {
      const std::uint32_t unique =
          hash32(options.seed, static_cast<std::uint32_t>(side_index), static_cast<std::uint32_t>(stretch.from_s * 10) + 5U);
      add_on_wall(scene, wall_place(side, is_outer, s), 0.297, 0.42, 1.35, 0.003, {Material::kPoster, unique}, kCorridorRoom);
    }
  }
}

void add_lamps(Scene* scene, const CorridorSide& side) {
  constexpr double kSpacing = 3.6;
  for (double s = 1.1; s < side.length - 1.2; s += kSpacing) {
    const Box box{s - 0.6, 1.1 - 0.15, kCorridorHeight - 0.06, s + 0.6, 1.1 + 0.15, kCorridorHeight};
    scene->add_box(side.place, box, {Material::kPlain, 21, 0.7F}, {Material::kPlain, 21, 0.7F}, kCorridorRoom, true);
    scene->surfaces.back().skin = {Material::kLamp, 22, 1.0F};  // the box's bottom, added last
    scene->lamps.push_back({side.place.point(s, 1.1, kCorridorHeight - 0.08), 1.5, kCorridorRoom, false});
  }
}

void add_shell(Scene* scene, const FloorPlan& plan, int side_index) {
  const CorridorSide& side = plan.sides[static_cast<std::size_t>(side_index)];
  const bool is_last_open = !plan.is_loop && side_index + 1 == static_cast<int>(plan.sides.size());
  const bool is_first_open = !plan.is_loop && side_index == 0;
  const double floor_end = is_last_open ? side.length : side.length - kCorridorWidth;
  for (const Stretch& stretch : side.stretches) {
    const double to = std::min(stretch.to_s, floor_end);
    if (to > stretch.from_s) {
      scene->add_floor(side.place, stretch.from_s, 0, to, kCorridorWidth, 0, floor_skin(stretch), kCorridorRoom);
      scene->add_ceiling(side.place, stretch.from_s, 0, to, kCorridorWidth, kCorridorHeight,
                         {Material::kCeiling, hash32(stretch.look, 102), 0.82F}, kCorridorRoom);
    }
    add_wall(scene, side.place, stretch.to_s, stretch.from_s, 0.0, doorways_of(plan, side_index, true), wall_skin(stretch), kCorridorRoom);
    const double inner_from = std::max(stretch.from_s, is_first_open ? 0.0 : kCorridorWidth);
    const double inner_to = std::min(stretch.to_s, is_last_open ? side.length : side.length - kCorridorWidth);
    if (inner_to > inner_from) {
      add_wall(scene, side.place, inner_from, inner_to, kCorridorWidth, doorways_of(plan, side_index, false), wall_skin(stretch),
               kCorridorRoom);
    }
  }
  const Skin end{Material::kPaint, 300, 0.75F};
  if (is_first_open) scene->add_upright(side.place, 0, 0, 0, kCorridorWidth, 0, kCorridorHeight, end, kCorridorRoom);
  if (is_last_open) scene->add_upright(side.place, side.length, kCorridorWidth, side.length, 0, 0, kCorridorHeight, end, kCorridorRoom);
  for (const Doorway& door : doorways_of(plan, side_index, true)) add_reveal(scene, side.place, door, -kWallThickness, 0.0);
  for (const Doorway& door : doorways_of(plan, side_index, false))
    add_reveal(scene, side.place, door, kCorridorWidth, kCorridorWidth + kWallThickness);
}

}  // namespace

void add_wall(Scene* scene, const Placement& place, double x0, double x1, double y, const std::vector<Doorway>& doorways, const Skin& skin,
              int room) {
  const double direction = x1 > x0 ? 1.0 : -1.0, length = std::fabs(x1 - x0);
  const auto piece = [&](double from, double to, double z0) {  // along the wall, from its left end
    if (to - from < 1e-6) return;
    Surface& s = scene->add_upright(place, x0 + direction * from, y, x0 + direction * to, y, z0, kCorridorHeight, skin, room);
    s.texture_u = static_cast<float>(from);
    s.texture_v = static_cast<float>(z0);
    s.texture_width = static_cast<float>(length);
    s.texture_height = static_cast<float>(kCorridorHeight);
  };
  std::vector<Doorway> cuts;
  for (const Doorway& d : doorways) {
    const double a = direction * (d.from - x0), b = direction * (d.to - x0);
    const Doorway cut{std::clamp(std::min(a, b), 0.0, length), std::clamp(std::max(a, b), 0.0, length)};
    if (cut.to > cut.from) cuts.push_back(cut);
  }
  std::sort(cuts.begin(), cuts.end(), [](const Doorway& a, const Doorway& b) { return a.from < b.from; });
  double done = 0;
  for (const Doorway& cut : cuts) {
    piece(done, cut.from, 0.0);
    piece(cut.from, cut.to, kDoorwayHeight);
    done = cut.to;
  }
  piece(done, length, 0.0);
}

void add_corridor_side(Scene* scene, const FloorPlan& plan, int side, const SceneOptions& options) {
  add_shell(scene, plan, side);
  add_lamps(scene, plan.sides[static_cast<std::size_t>(side)]);
  decorate_wall(scene, plan, side, true, options);
  decorate_wall(scene, plan, side, false, options);
}

}  // namespace camloc::sim
