// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/openni2/field_of_view.h"

#include <cmath>

namespace camloc::openni2 {

namespace {

bool is_plausible(double fov_rad) { return fov_rad > 0.05 && fov_rad < 3.1; }

}  // namespace

std::optional<Intrinsics> intrinsics_of(const StreamGeometry& geometry) {
  if (geometry.width <= 0 || geometry.height <= 0 || !is_plausible(geometry.horizontal_fov_rad)) return std::nullopt;
  Intrinsics intrinsics;
  intrinsics.width = geometry.width;
  intrinsics.height = geometry.height;
  intrinsics.fx = geometry.width / (2 * std::tan(geometry.horizontal_fov_rad / 2));
  intrinsics.fy = is_plausible(geometry.vertical_fov_rad) ? geometry.height / (2 * std::tan(geometry.vertical_fov_rad / 2)) : intrinsics.fx;
  intrinsics.cx = 0.5 * (geometry.width - 1);
  intrinsics.cy = 0.5 * (geometry.height - 1);
  return intrinsics.validate() ? std::optional(intrinsics) : std::nullopt;
}

std::optional<RgbdCamera> registered_camera(const StreamGeometry& color, int depth_width, int depth_height, double depth_unit_m) {
  const std::optional<Intrinsics> color_intrinsics = intrinsics_of(color);
  StreamGeometry depth = color;
  depth.width = depth_width > 0 ? depth_width : color.width;
  depth.height = depth_height > 0 ? depth_height : color.height;
  const std::optional<Intrinsics> depth_intrinsics = intrinsics_of(depth);
  if (!color_intrinsics || !depth_intrinsics) return std::nullopt;
  RgbdCamera camera;
  camera.name = "OpenNI2";
  camera.color = *color_intrinsics;
  camera.depth = *depth_intrinsics;
  camera.is_depth_registered = depth.width == color.width && depth.height == color.height;
  camera.depth_unit_m = depth_unit_m;
  return camera.validate() ? std::optional(camera) : std::nullopt;
}

}  // namespace camloc::openni2
