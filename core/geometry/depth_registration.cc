// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/depth_registration.h"

#include <algorithm>
#include <cmath>

namespace camloc {
namespace {

constexpr int kMaxSteps = 6;
constexpr double kMaxReprojection_px = 1.5;
constexpr double kMaxRelativeEdge = 0.05;

bool contains(ImageView<std::uint16_t> image, int x, int y) { return x >= 0 && y >= 0 && x < image.width && y < image.height; }

/// Nearest pixel, or -1 for what no image can contain (also NaN and points behind the camera).
int nearest_pixel(double coordinate) {
  return coordinate > -0.5 && coordinate < 65536.0 ? static_cast<int>(std::floor(coordinate + 0.5)) : -1;
}

}  // namespace

DepthLookup::DepthLookup(const RgbdCamera& camera)
    : camera_(camera),
      R_color_depth_(camera.T_color_depth.rotation.toRotationMatrix()),
      R_depth_color_(R_color_depth_.transpose()),
      t_color_depth_(camera.T_color_depth.translation),
      t_depth_color_(camera.T_color_depth.inverse().translation),
      color_rays_(camera.color),
      depth_rays_(camera.depth) {}

float DepthLookup::depth_at(ImageView<std::uint16_t> depth, float u, float v) const {
  if (depth.empty()) return 0.0F;
  if (camera_.is_depth_registered) return foreground_depth(depth, nearest_pixel(u), nearest_pixel(v));
  constexpr double kFarStart_m = 3.0;
  const float from_near = follow_epipolar_line(depth, u, v, std::max(camera_.min_depth_m, 0.5));
  const float from_far = follow_epipolar_line(depth, u, v, kFarStart_m);
  if (from_near == 0.0F || from_far == 0.0F) return std::max(from_near, from_far);
  return std::min(from_near, from_far);
}

float DepthLookup::foreground_depth(ImageView<std::uint16_t> depth, int x, int y) const {
  if (!contains(depth, x, y)) return 0.0F;
  const float centre = camera_.depth_m(depth.at(x, y));
  if (centre == 0.0F) return 0.0F;
  float nearest = centre;
  for (int j = std::max(y - 1, 0); j <= std::min(y + 1, depth.height - 1); ++j) {
    for (int i = std::max(x - 1, 0); i <= std::min(x + 1, depth.width - 1); ++i) {
      const float z = camera_.depth_m(depth.at(i, j));
      if (z > 0.0F) nearest = std::min(nearest, z);
    }
  }
  const double tolerance = kMaxRelativeEdge * centre + 3.0 * camera_.depth_noise.sigma_m(centre);
  return centre - nearest <= tolerance ? centre : 0.0F;
}

float DepthLookup::follow_epipolar_line(ImageView<std::uint16_t> depth, float u, float v, double start_m) const {
  const Eigen::Vector2f normalized = color_rays_.undistort(u, v);
  const Eigen::Vector3d ray_color(normalized.x(), normalized.y(), 1.0);
  const Eigen::Vector3d ray_in_depth = R_depth_color_ * ray_color;
  double z_color = start_m;
  for (int step = 0; step < kMaxSteps; ++step) {
    const Eigen::Vector3d p_depth = z_color * ray_in_depth + t_depth_color_;
    if (p_depth.z() <= 0.0) return 0.0F;
    const Eigen::Vector2d pixel = camera_.depth.project(p_depth);
    const int x = nearest_pixel(pixel.x()), y = nearest_pixel(pixel.y());
    if (!contains(depth, x, y)) return 0.0F;
    const float measured = camera_.depth_m(depth.at(x, y));
    if (measured == 0.0F) return 0.0F;
    const Eigen::Vector2f ray = depth_rays_.undistort(static_cast<float>(x), static_cast<float>(y));
    const Eigen::Vector3d p_color = R_color_depth_ * Eigen::Vector3d(ray.x() * measured, ray.y() * measured, measured) + t_color_depth_;
    if (p_color.z() <= 0.0) return 0.0F;
    const bool is_settled = std::abs(p_color.z() - z_color) < 1e-3 * z_color;
    z_color = p_color.z();
    if (!is_settled && step + 1 < kMaxSteps) continue;
    const Eigen::Vector2d back = camera_.color.project(p_color);
    const bool is_same_point = (back - Eigen::Vector2d(u, v)).squaredNorm() <= kMaxReprojection_px * kMaxReprojection_px;
    return is_same_point && foreground_depth(depth, x, y) > 0.0F ? static_cast<float>(z_color) : 0.0F;
  }
  return 0.0F;
}

}  // namespace camloc
