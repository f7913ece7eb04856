// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A whole depth image in the colour camera, the plain way: what the look-up of single pixels must agree with, and what it saves.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/base/frame.h"
#include "core/geometry/camera.h"

namespace camloc::testing {

/// The pixels whose centre lies within `radius` of `centre`, at least the nearest one, clipped to [0, size).
struct PixelRange {
  int begin, end;
};

inline PixelRange covered_pixels(double centre, double radius, int size) {
  if (!(centre > -2.0 && centre < size + 1.0)) return {0, 0};
  const int nearest = static_cast<int>(std::floor(centre + 0.5));
  const int first = std::min(nearest, static_cast<int>(std::ceil(centre - radius)));
  const int last = std::max(nearest, static_cast<int>(std::floor(centre + radius)));
  return {std::max(first, 0), std::min(last + 1, size)};
}

inline void splat(const RgbdCamera& camera, const Eigen::Vector3d& p_color, double footprint_radius_px, Image<float>* registered) {
  const Eigen::Vector2d pixel = camera.color.project(p_color);
  const PixelRange columns = covered_pixels(pixel.x(), footprint_radius_px, registered->width);
  const PixelRange rows = covered_pixels(pixel.y(), footprint_radius_px, registered->height);
  const float z = static_cast<float>(p_color.z());
  for (int y = rows.begin; y < rows.end; ++y) {
    for (int x = columns.begin; x < columns.end; ++x) {
      float& nearest = registered->at(x, y);
      if (nearest == 0.0F || z < nearest) nearest = z;
    }
  }
}

/// Metres per colour pixel, 0 where none, the nearest surface wins. `registered` is resized to the colour image.
inline void register_depth(const RgbdCamera& camera, ImageView<std::uint16_t> depth, Image<float>* registered) {
  registered->resize(camera.color.width, camera.color.height);
  std::fill(registered->pixels.begin(), registered->pixels.end(), 0.0F);
  const int width = std::min(depth.width, camera.depth.width), height = std::min(depth.height, camera.depth.height);
  const Eigen::Matrix3d R_color_depth = camera.T_color_depth.rotation.toRotationMatrix();
  const double magnification = camera.color.mean_focal_px() / camera.depth.mean_focal_px();
  if (depth.empty()) return;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float z = camera.depth_m(depth.at(x, y));
      if (z == 0.0F) continue;
      if (camera.is_depth_registered) {
        if (x < registered->width && y < registered->height) registered->at(x, y) = z;
        continue;
      }
      const Eigen::Vector2d ray = camera.depth.undistort(Eigen::Vector2d(x, y));
      const Eigen::Vector3d p_depth(ray.x() * z, ray.y() * z, z);
      const Eigen::Vector3d p_color = R_color_depth * p_depth + camera.T_color_depth.translation;
      // A depth pixel covers the colour pixels under its own area, so that a finer colour image gets no holes.
      if (p_color.z() > 0.0) splat(camera, p_color, 0.5 * magnification * z / p_color.z(), registered);
    }
  }
}

}  // namespace camloc::testing
