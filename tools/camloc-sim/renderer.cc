// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/camloc-sim/renderer.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace camloc::sim {
namespace {

constexpr double kNear = 0.05;  // metres

inline float dot(const float (&a)[3], float x, float y) { return a[0] * x + a[1] * y + a[2]; }

void copy(const Eigen::Vector3d& from, float (&to)[3]) {
  for (int i = 0; i < 3; ++i) to[i] = static_cast<float>(from[i]);
}

}  // namespace

Renderer::Renderer(const Scene& scene, const Intrinsics& intrinsics) : scene_(&scene), intrinsics_(intrinsics) {
  for (Image<float>* image : {&inverse_depth_, &rendering_.radiance, &rendering_.depth_m, &rendering_.cosine})
    image->resize(intrinsics.width, intrinsics.height);
  rendering_.surface.resize(intrinsics.width, intrinsics.height);
}

const Surface& Renderer::seen_surface(int index) const {
  const auto i = static_cast<std::size_t>(index);
  return i < scene_->surfaces.size() ? scene_->surfaces[i] : extra_[i - scene_->surfaces.size()];
}

const Rendering& Renderer::render(const Rigid3& T_world_camera, std::span<const Surface> extra) {
  extra_ = extra;
  R_camera_world_ = T_world_camera.rotation.toRotationMatrix().transpose();
  camera_position_ = T_world_camera.translation;
  std::fill(inverse_depth_.pixels.begin(), inverse_depth_.pixels.end(), 0.0F);
  std::fill(rendering_.surface.pixels.begin(), rendering_.surface.pixels.end(), -1);
  const std::size_t count = scene_->surfaces.size() + extra.size();
  views_.resize(count);
  for (std::size_t i = 0; i < count; ++i) draw(seen_surface(static_cast<int>(i)), static_cast<std::int32_t>(i));
  shade_all();
  return rendering_;
}

bool Renderer::make_view(const Surface& surface, View* view) const {
  const Eigen::Vector3d normal = surface.normal();
  const Eigen::Vector3d to_camera = camera_position_ - surface.origin;
  const double distance = normal.dot(to_camera);
  if (distance < 1e-4) return false;  // seen from behind
  view->surface = &surface;
  // Plane in camera axes: -normal . p = distance, so 1 / z = -normal . ray / distance.
  copy(R_camera_world_ * normal * (-1.0 / distance), view->normal);
  copy(R_camera_world_ * surface.u_axis, view->u_ray);
  copy(R_camera_world_ * surface.v_axis, view->v_ray);
  view->u_offset = static_cast<float>(surface.u_axis.dot(to_camera));
  view->v_offset = static_cast<float>(surface.v_axis.dot(to_camera));
  view->inverse_distance = static_cast<float>(1.0 / distance);
  return true;
}

void Renderer::draw(const Surface& surface, std::int32_t index) {
  View& view = views_[static_cast<std::size_t>(index)];
  if (!make_view(surface, &view)) return;
  const Eigen::Vector3d origin = R_camera_world_ * (surface.origin - camera_position_);
  const Eigen::Vector3d u = R_camera_world_ * surface.u_axis * surface.width, v = R_camera_world_ * surface.v_axis * surface.height;
  const std::array<Eigen::Vector3d, 4> corners{origin, origin + u, origin + u + v, origin + v};
  // Entirely behind the camera, or outside one side plane of its field of view.
  const double left = -intrinsics_.cx / intrinsics_.fx, right = (intrinsics_.width - intrinsics_.cx) / intrinsics_.fx;
  const double top = -intrinsics_.cy / intrinsics_.fy, bottom = (intrinsics_.height - intrinsics_.cy) / intrinsics_.fy;
  const auto outside = [&](auto predicate) { return std::all_of(corners.begin(), corners.end(), predicate); };
  if (outside([&](const Eigen::Vector3d& p) { return p.z() < kNear; }) ||
      outside([&](const Eigen::Vector3d& p) { return p.x() < left * p.z(); }) ||
      outside([&](const Eigen::Vector3d& p) { return p.x() > right * p.z(); }) ||
      outside([&](const Eigen::Vector3d& p) { return p.y() < top * p.z(); }) ||
      outside([&](const Eigen::Vector3d& p) { return p.y() > bottom * p.z(); })) {
    return;
  }
  polygon_.clear();
  const auto project = [&](const Eigen::Vector3d& p) {
    polygon_.emplace_back(intrinsics_.fx * p.x() / p.z() + intrinsics_.cx, intrinsics_.fy * p.y() / p.z() + intrinsics_.cy);
  };
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector3d &a = corners[i], &b = corners[(i + 1) % 4];
    if (a.z() >= kNear) project(a);
    if ((a.z() >= kNear) != (b.z() >= kNear)) project(a + (b - a) * ((kNear - a.z()) / (b.z() - a.z())));
  }
  fill_polygon(polygon_, view, index);
}

void Renderer::fill_polygon(const std::vector<Eigen::Vector2d>& polygon, const View& view, std::int32_t index) {
  constexpr double kSlack = 1e-3;  // pixels: neighbours overlap rather than leave a crack
  double top = 1e9, bottom = -1e9;
  for (const Eigen::Vector2d& p : polygon) {
    top = std::min(top, p.y());
    bottom = std::max(bottom, p.y());
  }
  const int y_first = static_cast<int>(std::max(0.0, std::ceil(top - kSlack)));
  const int y_last = static_cast<int>(std::min<double>(intrinsics_.height - 1, std::floor(bottom + kSlack)));
  const float a = view.normal[0] / static_cast<float>(intrinsics_.fx);
  for (int y = y_first; y <= y_last; ++y) {
    double low = 1e9, high = -1e9;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Eigen::Vector2d &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
      const double y0 = std::min(p.y(), q.y()), y1 = std::max(p.y(), q.y());
      if (y < y0 - kSlack || y > y1 + kSlack) continue;
      const double t = y1 - y0 > 1e-9 ? std::clamp((y - p.y()) / (q.y() - p.y()), 0.0, 1.0) : 0.0;
      const double x = p.x() + t * (q.x() - p.x());
      low = std::min({low, x, y1 - y0 > 1e-9 ? x : q.x()});
      high = std::max({high, x, y1 - y0 > 1e-9 ? x : q.x()});
    }
    const int x_first = static_cast<int>(std::max(0.0, std::ceil(low - kSlack)));
    const int x_last = static_cast<int>(std::min<double>(intrinsics_.width - 1, std::floor(high + kSlack)));
    const float ray_y = static_cast<float>((y - intrinsics_.cy) / intrinsics_.fy);
    const float at_zero = dot(view.normal, static_cast<float>(-intrinsics_.cx / intrinsics_.fx), ray_y);
    float* nearest = inverse_depth_.row(y);
    std::int32_t* ids = rendering_.surface.row(y);
    for (int x = x_first; x <= x_last; ++x) {
      const float value = at_zero + a * static_cast<float>(x);
      const bool is_nearer = value > nearest[x];
      nearest[x] = is_nearer ? value : nearest[x];
      ids[x] = is_nearer ? index : ids[x];
    }
  }
}

Renderer::Hit Renderer::intersect(const View& view, float ray_x, float ray_y) const {
  const float inverse = dot(view.normal, ray_x, ray_y);
  const float depth = inverse > 1e-6F ? 1.0F / inverse : 1e6F;
  const float cosine = inverse / (view.inverse_distance * std::sqrt(ray_x * ray_x + ray_y * ray_y + 1.0F));
  return {depth * dot(view.u_ray, ray_x, ray_y) + view.u_offset, depth * dot(view.v_ray, ray_x, ray_y) + view.v_offset, depth, cosine};
}

float Renderer::shade(const View& view, const Hit& hit) const {
  const Surface& s = *view.surface;
  // Pixel size on the surface: halfway between its short side and its long, foreshortened one.
  const float foot = hit.depth / static_cast<float>(intrinsics_.fx) / std::sqrt(std::max(hit.cosine, 0.02F));
  const float tone =
      std::max(0.02F, texture_tone(s.skin, {hit.u + s.texture_u, hit.v + s.texture_v, s.texture_width, s.texture_height, foot}));
  if (is_emissive(s.skin.material)) return 0.9F * tone * tone;
  const float x = std::clamp(hit.u / static_cast<float>(s.width), 0.0F, 0.9999F) * static_cast<float>(s.light_columns - 1);
  const float y = std::clamp(hit.v / static_cast<float>(s.height), 0.0F, 0.9999F) * static_cast<float>(s.light_rows - 1);
  const int i = static_cast<int>(x), j = static_cast<int>(y);
  const float fx = x - static_cast<float>(i), fy = y - static_cast<float>(j);
  const float* node = s.light.data() + j * s.light_columns + i;
  const float low = node[0] + (node[1] - node[0]) * fx,
              high = node[s.light_columns] + (node[s.light_columns + 1] - node[s.light_columns]) * fx;
  return tone * tone * (low + (high - low) * fy);
}

float Renderer::shade_silhouette(int x, int y) const {
  std::array<std::int32_t, 9> ids{};
  std::size_t count = 0;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const int nx = std::clamp(x + dx, 0, intrinsics_.width - 1), ny = std::clamp(y + dy, 0, intrinsics_.height - 1);
      const std::int32_t id = rendering_.surface.at(nx, ny);
      if (id >= 0 &&
          std::find(ids.begin(), ids.begin() + static_cast<std::ptrdiff_t>(count), id) == ids.begin() + static_cast<std::ptrdiff_t>(count))
        ids[count++] = id;
    }
  }
  float sum = 0;
  for (int sample = 0; sample < 4; ++sample) {
    const double px = x + (sample & 1 ? 0.25 : -0.25), py = y + (sample & 2 ? 0.25 : -0.25);
    const float ray_x = static_cast<float>((px - intrinsics_.cx) / intrinsics_.fx),
                ray_y = static_cast<float>((py - intrinsics_.cy) / intrinsics_.fy);
    const View* best = nullptr;
    Hit best_hit{0, 0, 1e6F, 0};
    for (std::size_t k = 0; k < count; ++k) {
      const View& view = views_[static_cast<std::size_t>(ids[k])];
      const Hit hit = intersect(view, ray_x, ray_y);
      constexpr float kSlack = 1e-3F;
      const bool is_inside = hit.u > -kSlack && hit.v > -kSlack && hit.u < static_cast<float>(view.surface->width) + kSlack &&
                             hit.v < static_cast<float>(view.surface->height) + kSlack;
      if (is_inside && hit.depth < best_hit.depth) {
        best_hit = hit;
        best = &view;
      }
    }
    if (best != nullptr) sum += 0.25F * shade(*best, best_hit);
  }
  return sum;
}

void Renderer::shade_all() {
  const int width = intrinsics_.width, height = intrinsics_.height;
  for (int y = 0; y < height; ++y) {
    const float ray_y = static_cast<float>((y - intrinsics_.cy) / intrinsics_.fy);
    const std::int32_t* ids = rendering_.surface.row(y);
    const std::int32_t* above = rendering_.surface.row(std::max(y - 1, 0));
    const std::int32_t* below = rendering_.surface.row(std::min(y + 1, height - 1));
    for (int x = 0; x < width; ++x) {
      const std::int32_t id = ids[x];
      const float inverse = inverse_depth_.at(x, y);
      rendering_.depth_m.at(x, y) = inverse > 0.0F ? 1.0F / inverse : 0.0F;
      const bool is_silhouette = ids[std::max(x - 1, 0)] != id || ids[std::min(x + 1, width - 1)] != id || above[x] != id || below[x] != id;
      float radiance = 0, cosine = 0;
      if (id >= 0) {
        const View& view = views_[static_cast<std::size_t>(id)];
        const Hit hit = intersect(view, static_cast<float>((x - intrinsics_.cx) / intrinsics_.fx), ray_y);
        cosine = hit.cosine;
        radiance = is_silhouette ? shade_silhouette(x, y) : shade(view, hit);
      }
      rendering_.radiance.at(x, y) = radiance;
      rendering_.cosine.at(x, y) = cosine;
    }
  }
}

}  // namespace camloc::sim
