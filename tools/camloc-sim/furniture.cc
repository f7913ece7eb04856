// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/camloc-sim/building.h"
#include "tools/camloc-sim/noise.h"

namespace camloc::sim {
namespace {

constexpr double kDeskHeight = 0.74;

void add_monitor(Scene* scene, const Placement& desk, double x, const Seeds& seeds, int room) {
  const Placement place = desk.child(x, -0.22, range(hash32(seeds.object, 3), -0.25F, 0.25F));
  const Skin body{Material::kPlain, 3, 0.12F};
  const Skin content{Material::kScreen, hash32(seeds.object, seeds.day, 4)};
  scene->add_box(place, {-0.28, -0.02, kDeskHeight + 0.12, 0.28, 0.02, kDeskHeight + 0.48}, body, content, room, true);
  scene->add_box(place, {-0.03, -0.01, kDeskHeight, 0.03, 0.04, kDeskHeight + 0.12}, body, body, room, true);
  scene->add_box(place, {-0.12, -0.08, kDeskHeight, 0.12, 0.08, kDeskHeight + 0.012}, body, body, room, true);
}

void add_sheet(Scene* scene, const Placement& place, double z, double width, double height, const Skin& look, int room) {
  scene->add_floor(place, -0.5 * width, -0.5 * height, 0.5 * width, 0.5 * height, z, look, room).is_static = false;
}

void add_desk_clutter(Scene* scene, const Placement& desk, const Seeds& seeds, int room) {
  const std::uint32_t today = hash32(seeds.object, seeds.day);
  for (std::uint32_t k = 0; k < 4; ++k) {
    // Half of the sheets stay where they were.
    const std::uint32_t h = hash32(k % 2U == 0U ? seeds.object : today, 20U + k);
    const Placement at =
        desk.child(range(hash32(h, 1), 0.15F, 1.45F), range(hash32(h, 2), -0.65F, -0.15F), range(hash32(h, 3), -1.0F, 1.0F));
    add_sheet(scene, at, kDeskHeight + 0.002 + 0.001 * k, 0.21, 0.297, Skin{Material::kPaper, hash32(h, 4)}, room);
  }
  const std::uint32_t mug = hash32(today, 40);
  const Placement at =
      desk.child(range(hash32(mug, 1), 0.2F, 1.4F), range(hash32(mug, 2), -0.6F, -0.4F), range(hash32(mug, 3), 0.0F, 3.0F));
  const Skin china{Material::kSign, hash32(seeds.object, 41), 0.85F};
  scene->add_box(at, {-0.04, -0.04, kDeskHeight, 0.04, 0.04, kDeskHeight + 0.1}, china, china, room, false);
  double z = kDeskHeight;
  for (std::uint32_t k = 0; k < 4; ++k) {
    const std::uint32_t h = hash32(seeds.object, 50U + k);
    const Placement pile = desk.child(1.42, -0.2, range(h, -0.2F, 0.2F));
    const double thickness = range(hash32(h, 1), 0.015F, 0.05F);
    const Skin cover{Material::kSign, h, range(hash32(h, 2), 0.2F, 0.9F)};
    scene->add_box(pile, {-0.1, -0.14, z, 0.1, 0.14, z + thickness}, cover, cover, room, true);
    z += thickness;
  }
}

}  // namespace

void add_desk(Scene* scene, const Placement& place, const Seeds& seeds, int room) {
  const Skin wood{Material::kWood, seeds.object, range(hash32(seeds.object, 1), 0.45F, 0.72F)};
  const Skin metal{Material::kPlain, 5, 0.3F};
  scene->add_box(place, {0.0, -0.8, kDeskHeight - 0.03, 1.6, -0.01, kDeskHeight}, wood, wood, room, true);
  scene->add_box(place, {0.02, -0.72, 0.0, 0.06, -0.08, kDeskHeight - 0.03}, metal, metal, room, true);
  scene->add_box(place, {1.15, -0.72, 0.08, 1.56, -0.08, kDeskHeight - 0.03}, wood, Skin{Material::kRibs, 6, 0.5F}, room, true);
  add_monitor(scene, place, 0.55, seeds, room);
  if (hash32(seeds.object, 2) % 2U == 0U) add_monitor(scene, place, 1.15, {hash32(seeds.object, 7), seeds.day}, room);
  const Placement keyboard = place.child(0.55 + range(hash32(seeds.object, seeds.day, 8), -0.06F, 0.06F), -0.55,
                                         range(hash32(seeds.object, seeds.day, 9), -0.1F, 0.1F));
  scene->add_box(keyboard, {-0.22, -0.07, kDeskHeight, 0.22, 0.07, kDeskHeight + 0.018},
                 Skin{Material::kKeyboard, hash32(seeds.object, 10)}, metal, room, false);
  add_desk_clutter(scene, place, seeds, room);
}

void add_bookshelf(Scene* scene, const Placement& place, double width_m, const Seeds& seeds, int room) {
  const Skin wood{Material::kWood, hash32(seeds.object, 1), 0.5F};
  scene->add_box(place, {0.0, -0.3, 0.0, width_m, -0.01, 2.05}, wood, Skin{Material::kBooks, hash32(seeds.object, 2)}, room, true);
}

void add_chair(Scene* scene, const Placement& place, const Seeds& seeds, int room) {
  const Skin cloth{Material::kFabric, hash32(seeds.object, 1), range(hash32(seeds.object, 2), 0.15F, 0.5F)};
  const Skin metal{Material::kPlain, 9, 0.2F};
  scene->add_box(place, {-0.24, -0.24, 0.42, 0.24, 0.24, 0.5}, cloth, cloth, room, false);
  scene->add_box(place, {-0.22, 0.2, 0.55, 0.22, 0.26, 1.0}, cloth, cloth, room, false);
  scene->add_box(place, {-0.03, -0.03, 0.08, 0.03, 0.03, 0.42}, metal, metal, room, false);
  scene->add_box(place, {-0.3, -0.04, 0.02, 0.3, 0.04, 0.08}, metal, metal, room, false);
  scene->add_box(place, {-0.04, -0.3, 0.02, 0.04, 0.3, 0.08}, metal, metal, room, false);
}

void add_box_pile(Scene* scene, const Placement& place, const Seeds& seeds, int room) {
  const int count = 1 + static_cast<int>(hash32(seeds.object, 1) % 3U);
  double z = 0;
  for (int k = 0; k < count; ++k) {
    const std::uint32_t h = hash32(seeds.object, 10U + static_cast<std::uint32_t>(k));
    const double half_x = range(hash32(h, 1), 0.16F, 0.28F), half_y = range(hash32(h, 2), 0.14F, 0.24F),
                 height = range(hash32(h, 3), 0.2F, 0.36F);
    const Skin look{Material::kCardboard, hash32(h, 4), range(hash32(h, 5), 0.45F, 0.65F)};
    scene->add_box(place.child(0, 0, range(hash32(h, seeds.day, 6), -0.3F, 0.3F)), {-half_x, -half_y, z, half_x, half_y, z + height}, look,
                   look, room, false);
    z += height;
  }
}

void add_cabinet(Scene* scene, const Placement& place, const Seeds& seeds, int room) {
  const Skin body{Material::kPlain, 12, 0.55F};
  scene->add_box(place, {0.0, -0.45, 0.0, 0.8, -0.01, 1.25}, body, body, room, true);
  for (std::uint32_t k = 0; k < 3; ++k) {
    const double z = 0.08 + 0.39 * k;
    const Skin drawer{Material::kPlain, 13, 0.62F};
    scene->add_box(place, {0.03, -0.47, z, 0.77, -0.45, z + 0.36}, drawer, drawer, room, true);
    const Skin label{Material::kSign, hash32(seeds.object, k), 0.92F};
    scene->add_upright(place, 0.3, -0.472, 0.42, -0.472, z + 0.22, z + 0.29, label, room);
    const Skin handle{Material::kPlain, 14, 0.15F};
    scene->add_upright(place, 0.5, -0.472, 0.68, -0.472, z + 0.24, z + 0.27, handle, room);
  }
  for (std::uint32_t k = 0; k < 3; ++k) {
    const std::uint32_t h = hash32(seeds.object, 30U + k);
    const Skin folder{Material::kSign, h, range(h, 0.2F, 0.9F)};
    const double x = 0.1 + 0.22 * k;
    scene->add_box(place, {x, -0.4, 1.25, x + 0.08, -0.1, 1.25 + 0.32}, folder, folder, room, true);
  }
}

void add_radiator(Scene* scene, const Placement& place, double width_m, int room) {
  const Skin metal{Material::kPlain, 15, 0.8F};
  scene->add_box(place, {0.0, -0.11, 0.12, width_m, -0.03, 0.7}, metal, Skin{Material::kRibs, 16, 0.75F}, room, true);
}

void add_closed_door(Scene* scene, const Placement& place, std::uint32_t plate_seed, int room) {
  constexpr double kWidth = 0.95, kHeight = 2.08;
  const Skin frame{Material::kPlain, 17, 0.35F}, leaf = Skin{Material::kWood, 18, 0.56F}, metal = Skin{Material::kPlain, 19, 0.75F};
  scene->add_box(place, {-0.06, -0.03, 0.0, 0.0, 0.0, kHeight}, frame, frame, room, true);
  scene->add_box(place, {kWidth, -0.03, 0.0, kWidth + 0.06, 0.0, kHeight}, frame, frame, room, true);
  scene->add_box(place, {-0.06, -0.03, kHeight, kWidth + 0.06, 0.0, kHeight + 0.06}, frame, frame, room, true);
  scene->add_upright(place, 0.0, -0.008, kWidth, -0.008, 0.0, kHeight, leaf, room);
  scene->add_box(place, {kWidth - 0.11, -0.06, 1.02, kWidth - 0.07, -0.008, 1.14}, metal, metal, room, true);
  scene->add_box(place, {kWidth - 0.20, -0.07, 1.06, kWidth - 0.07, -0.05, 1.09}, metal, metal, room, true);
  add_on_wall(scene, place.child(kWidth + 0.25, 0, 0), 0.22, 0.14, 1.5, 0.006, Skin{Material::kSign, plate_seed, 0.9F}, room);
}

void add_on_wall(Scene* scene, const Placement& place, double width_m, double height_m, double bottom_z, double depth_m, const Skin& look,
                 int room) {
  const Skin edge{Material::kPlain, 20, 0.3F};
  scene->add_box(place, {-0.5 * width_m, -depth_m, bottom_z, 0.5 * width_m, 0.0, bottom_z + height_m}, edge, look, room, true);
}

void add_person(Scene* scene, const Placement& place, std::uint32_t seed, double stride, int room) {
  const double scale = range(hash32(seed, 1), 0.93F, 1.08F);
  const Skin trousers{Material::kCloth, hash32(seed, 2) / 3U * 3U + 1U, range(hash32(seed, 3), 0.12F, 0.4F)};
  const Skin shirt{Material::kCloth, hash32(seed, 4), range(hash32(seed, 5), 0.25F, 0.8F)};
  const Skin face{Material::kFabric, hash32(seed, 6), 0.6F}, hair = Skin{Material::kFabric, hash32(seed, 7), 0.15F};
  const double step = 0.25 * stride;
  const auto part = [&](double x0, double y0, double z0, double x1, double y1, double z1, const Skin& look) {
    scene->add_box(place, {x0 * scale, y0 * scale, z0 * scale, x1 * scale, y1 * scale, z1 * scale}, look, look, room, false);
  };
  part(-0.17, -0.08 - step, 0.0, -0.02, 0.08 - step, 0.85, trousers);
  part(0.02, -0.08 + step, 0.0, 0.17, 0.08 + step, 0.85, trousers);
  part(-0.21, -0.12, 0.85, 0.21, 0.12, 1.45, shirt);
  part(-0.30, -0.06 + step, 0.8, -0.21, 0.06 + step, 1.42, shirt);
  part(0.21, -0.06 - step, 0.8, 0.30, 0.06 - step, 1.42, shirt);
  part(-0.09, -0.1, 1.48, 0.09, 0.1, 1.68, face);
  part(-0.095, -0.105, 1.68, 0.095, 0.105, 1.76, hair);
}

}  // namespace camloc::sim
