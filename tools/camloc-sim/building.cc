// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/camloc-sim/building.h"

#include <algorithm>
#include <numbers>

#include "tools/camloc-sim/corridor.h"
#include "tools/camloc-sim/noise.h"
#include "tools/camloc-sim/office.h"

namespace camloc::sim {
namespace {

constexpr double kPi = std::numbers::pi;

FloorPlan large_plan() {
  FloorPlan plan;
  plan.sides = {
      {{{0, 0}, 0}, 57, {{0, 2.2, 1}, {2.2, 10, 2}, {10, 22, 50}, {22, 30, 3}, {30, 38, 51}, {38, 46, 51}, {46, 57, 4}}},
      {{{57, 0}, 0.5 * kPi}, 40, {{0, 2.2, 5}, {2.2, 12, 6}, {12, 22, 7, true}, {22, 40, 8}}},
      {{{57, 40}, kPi}, 57, {{0, 2.2, 9}, {2.2, 10, 10}, {10, 22, 50}, {22, 36, 11}, {36, 45, 12, true}, {45, 57, 13}}},
      {{{0, 40}, 1.5 * kPi}, 40, {{0, 2.2, 14}, {2.2, 14, 15}, {14, 22, 51}, {22, 40, 16}}},
  };
  plan.offices = {{0, true, 3.5, 4.5, 5.0, 1},   {0, true, 23.5, 5.0, 4.6, 2}, {0, false, 47.5, 4.8, 5.0, 3},
                  {1, true, 4.0, 4.8, 5.0, 4},   {1, true, 28.0, 4.5, 4.8, 5}, {2, true, 3.5, 4.6, 5.0, 6},
                  {2, false, 26.0, 5.2, 4.8, 7}, {3, true, 5.0, 4.5, 5.0, 8},  {3, false, 27.0, 4.8, 5.0, 9}};
  return plan;
}

FloorPlan small_plan() {
  FloorPlan plan;
  plan.is_loop = false;
  plan.sides = {
      {{{0, 0}, 0}, 10, {{0, 7.8, 2}, {7.8, 10, 1}}},
      {{{10, 0}, 0.5 * kPi}, 8, {{0, 2.2, 5}, {2.2, 8, 6}}},
  };
  plan.offices = {{0, true, 3.0, 4.5, 4.6, 1}, {1, false, 3.0, 4.6, 4.6, 2}};
  return plan;
}

/// Which lamps burn and how the light falls on this day.
void set_light(Scene* scene, const SceneOptions& options) {
  if (options.day == 1) {
    scene->day_light = {0.20, {0.10, 0.15, 0.0}};
    return;
  }
  scene->day_light = {0.16, {-0.45, 0.30, 0.10}};
  for (std::size_t i = 0; i < scene->lamps.size(); ++i) {
    Lamp& lamp = scene->lamps[i];
    const std::uint32_t h = hash32(options.seed, options.day, static_cast<std::uint32_t>(i) + 77U);
    if (lamp.is_window) {
      lamp.power *= 1.6;  // a brighter sky
    } else {
      lamp.power *= h % 6U == 0U ? 0.0 : range(hash32(h, 1), 0.65F, 1.1F);
    }
  }
}

/// Lamps that are off look dark.
void darken_dead_lamps(Scene* scene) {
  for (Surface& surface : scene->surfaces) {
    if (surface.skin.material != Material::kLamp) continue;
    const Eigen::Vector3d centre = surface.at(0.5 * surface.width, 0.5 * surface.height);
    for (const Lamp& lamp : scene->lamps) {
      if (lamp.power == 0.0 && (lamp.position - centre).norm() < 0.3) surface.skin = {Material::kPlain, 30, 0.75F};
    }
  }
}

}  // namespace

FloorPlan floor_plan(SceneKind kind) { return kind == SceneKind::kSmall ? small_plan() : large_plan(); }

Placement office_place(const FloorPlan& plan, const Office& office) {
  const Placement& side = plan.sides[static_cast<std::size_t>(office.side)].place;
  if (office.is_outer) return side.child(office.from_s + office.width, -kWallThickness, kPi);
  return side.child(office.from_s, kCorridorWidth + kWallThickness, 0.0);
}

Scene build_scene(const FloorPlan& plan, const SceneOptions& options) {
  Scene scene;
  for (int side = 0; side < static_cast<int>(plan.sides.size()); ++side) add_corridor_side(&scene, plan, side, options);
  for (const Office& office : plan.offices) add_office(&scene, office_place(plan, office), office, options);
  set_light(&scene, options);
  darken_dead_lamps(&scene);
  scene.bake_light();
  return scene;
}

}  // namespace camloc::sim
