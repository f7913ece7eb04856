// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/camloc-sim/scene.h"

#include <algorithm>
#include <cmath>

namespace camloc::sim {

Eigen::Vector3d Placement::point(double x, double y, double z) const {
  const Eigen::Vector3d offset = direction(x, y);
  return {origin.x() + offset.x(), origin.y() + offset.y(), z};
}

Eigen::Vector3d Placement::direction(double x, double y) const {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  return {c * x - s * y, s * x + c * y, 0.0};
}

Placement Placement::child(double x, double y, double child_angle_rad) const {
  return {point(x, y, 0).head<2>(), angle_rad + child_angle_rad};
}

Surface& Scene::add(const Eigen::Vector3d& origin, const Eigen::Vector3d& u_axis, const Eigen::Vector3d& v_axis, double width,
                    double height, const Skin& skin, int room) {
  surfaces.push_back({origin, u_axis, v_axis, width, height, skin, 0, 0, static_cast<float>(width), static_cast<float>(height), room});
  return surfaces.back();
}

Surface& Scene::add_upright(const Placement& place, double x0, double y0, double x1, double y1, double z0, double z1, const Skin& skin,
                            int room) {
  const double width = std::hypot(x1 - x0, y1 - y0);
  return add(place.point(x0, y0, z0), place.direction((x1 - x0) / width, (y1 - y0) / width), Eigen::Vector3d::UnitZ(), width, z1 - z0, skin,
             room);
}

Surface& Scene::add_floor(const Placement& place, double x0, double y0, double x1, double y1, double z, const Skin& skin, int room) {
  return add(place.point(x0, y0, z), place.direction(1, 0), place.direction(0, 1), x1 - x0, y1 - y0, skin, room);
}

Surface& Scene::add_ceiling(const Placement& place, double x0, double y0, double x1, double y1, double z, const Skin& skin, int room) {
  return add(place.point(x0, y1, z), place.direction(1, 0), place.direction(0, -1), x1 - x0, y1 - y0, skin, room);
}

void Scene::add_box(const Placement& place, const Box& b, const Skin& sides, const Skin& front, int room, bool is_static) {
  const std::size_t first = surfaces.size();
  constexpr double kHidden = 0.003;  // what stands on the floor has no visible bottom, what is flat no visible sides
  if (b.z1 - b.z0 > kHidden) {
    add_upright(place, b.x0, b.y0, b.x1, b.y0, b.z0, b.z1, front, room);
    add_upright(place, b.x1, b.y0, b.x1, b.y1, b.z0, b.z1, sides, room);
    add_upright(place, b.x1, b.y1, b.x0, b.y1, b.z0, b.z1, sides, room);
    add_upright(place, b.x0, b.y1, b.x0, b.y0, b.z0, b.z1, sides, room);
  }
  add_floor(place, b.x0, b.y0, b.x1, b.y1, b.z1, sides, room);
  if (b.z0 > 0.3) add_ceiling(place, b.x0, b.y0, b.x1, b.y1, b.z0, sides, room);
  for (std::size_t i = first; i < surfaces.size(); ++i) surfaces[i].is_static = is_static;
}

float Scene::light_at(const Eigen::Vector3d& point, const Eigen::Vector3d& normal, int room) const {
  double light = day_light.ambient * (1.0 + 0.25 * -normal.z()) + 0.35 * day_light.ambient * day_light.tilt.dot(normal);
  for (const Lamp& lamp : lamps) {
    if (lamp.room != room) continue;
    const Eigen::Vector3d to_lamp = lamp.position - point;
    const double squared = to_lamp.squaredNorm();
    if (squared > 81.0) continue;  // beyond 9 m a lamp adds less than a grey level
    const double inverse = 1.0 / std::sqrt(squared + 1e-9);
    // Wrapped cosine: light bounces off the opposite wall, so faces turned slightly away are not black.
    const double received = std::max(0.0, (normal.dot(to_lamp) * inverse + 0.25) / 1.25);
    const double sent = lamp.is_window ? 0.8 : 0.15 + 0.85 * std::max(0.0, to_lamp.z() * inverse);
    light += lamp.power * received * sent / (squared + 0.6);
  }
  return static_cast<float>(light);
}

void Scene::bake_light(Surface* surface) const {
  constexpr double kSpacing = 0.5;
  surface->light_columns = 2 + static_cast<int>(surface->width / kSpacing);
  surface->light_rows = 2 + static_cast<int>(surface->height / kSpacing);
  surface->light.clear();
  const Eigen::Vector3d normal = surface->normal();
  for (int j = 0; j < surface->light_rows; ++j) {
    for (int i = 0; i < surface->light_columns; ++i) {
      const Eigen::Vector3d p =
          surface->at(surface->width * i / (surface->light_columns - 1), surface->height * j / (surface->light_rows - 1));
      surface->light.push_back(light_at(p, normal, surface->room));
    }
  }
}

void Scene::bake_light() {
  for (Surface& surface : surfaces) bake_light(&surface);
}

}  // namespace camloc::sim
