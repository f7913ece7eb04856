// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/camloc-sim/building.h"

#include "tools/camloc-sim/noise.h"

namespace camloc::sim {
namespace {

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
