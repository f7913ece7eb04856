// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Coloured points and lines drawn into a picture, from above, from the side, or in perspective: what map and cloud look like.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/geometry/rigid3.h"
#include "drivers/image_file.h"

namespace camloc::map_tool {

using Rgb = std::array<std::uint8_t, 3>;

/// What is drawn onto a picture: an axis-parallel view, or a pinhole camera.
struct Viewpoint {
  Rigid3 T_view_world;        ///< view axes: x right, y down, z away from the eye
  bool is_perspective = false;
  double px_per_m = 100;      ///< orthographic: pixels a metre; perspective: focal length in pixels
  double center_u = 0, center_v = 0;   ///< pixel of the optical axis
};

/// Seen along -up: the whole of `points` (1st to 99th percentile) fits into width x height with a margin. `right` may be any
/// vector that is not parallel to `up`; zero: the direction of the largest extent.
[[nodiscard]] Viewpoint fit_top_view(std::span<const Eigen::Vector3d> points, const Eigen::Vector3d& up, int width, int height,
                                     int margin_px);
/// Seen horizontally, up is up.
[[nodiscard]] Viewpoint fit_side_view(std::span<const Eigen::Vector3d> points, const Eigen::Vector3d& up, int width, int height,
                                      int margin_px);
/// Seen from above and aside in perspective.
[[nodiscard]] Viewpoint fit_perspective_view(std::span<const Eigen::Vector3d> points, const Eigen::Vector3d& up, int width, int height,
                                             int margin_px);

/// A picture with a depth buffer.
class PointRaster {
 public:
  PointRaster(int width, int height, Rgb background);
  void add_points(const Viewpoint& view, std::span<const Eigen::Vector3d> points, std::span<const Rgb> colors, double radius_px);
  void add_line(const Viewpoint& view, std::span<const Eigen::Vector3d> line, Rgb color, double width_px);
  /// A camera as a small pyramid.
  void add_camera(const Viewpoint& view, const Rigid3& T_world_camera, double size_m, Rgb color);
  void add_text(int u, int v, const std::string& text, double height_px, Rgb color);
  void add_rectangle(int u, int v, int width, int height, Rgb color);
  /// A bar of a round length with its label; orthographic views.
  void add_scale_bar(const Viewpoint& view, int u, int v, Rgb color);
  /// A colour ramp with labels at both ends.
  void add_legend(int u, int v, int width, const std::string& low, const std::string& high, std::span<const Rgb> ramp);
  [[nodiscard]] const ColorImage& image() const { return image_; }

 private:
  ColorImage image_;
  std::vector<float> depth_;
};

/// Perceptually even ramp (256 entries) for values, readable without red-green vision.
[[nodiscard]] std::span<const Rgb> value_ramp();

}  // namespace camloc::map_tool
