// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Coloured points and lines drawn into a picture, from above, from the side, or in perspective: what map and cloud look like.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "core/geometry/rigid3.h"
#include "core/io/image_file.h"
#include "tools/common/drawing.h"

namespace camloc::mapping {

using tools::Rgb;

/// What is drawn onto a picture: an axis-parallel view, or a pinhole camera.
struct Viewpoint {
  Rigid3 T_view_world;  ///< view axes: x right, y down, z away from the eye
  bool is_perspective = false;
  double px_per_m = 100;              ///< orthographic: pixels a metre; perspective: focal length in pixels
  double center_u = 0, center_v = 0;  ///< pixel of the optical axis

  /// Of a point in view axes, in perspective before the eye.
  [[nodiscard]] Eigen::Vector2d pixel_of(const Eigen::Vector3d& p_view) const {
    return Eigen::Vector2d(center_u, center_v) + p_view.head<2>() * (is_perspective ? px_per_m / p_view.z() : px_per_m);
  }
};

/// Between which coordinates something lies along an axis.
struct Extent {
  double low = 0, high = 0;
  [[nodiscard]] double length() const { return std::max(0.1, high - low); }
  [[nodiscard]] double middle() const { return 0.5 * (low + high); }
};

/// The parallel view with the given axes (rows: right, down, away) in which `u` and `v`, along the first two, fill the picture.
[[nodiscard]] Viewpoint parallel_view(const Eigen::Matrix3d& axes, const Extent& u, const Extent& v, int width, int height, int margin_px);
/// Unit vectors across `up` in steps of a degree over a quarter turn: walls run along one of them. The first is the world's own axis
/// that lies flattest, so that a map with straight walls keeps its axes.
[[nodiscard]] std::vector<Eigen::Vector3d> level_directions(const Eigen::Vector3d& up);
/// `axis` or its opposite, so that its largest component is positive.
[[nodiscard]] Eigen::Vector3d turned_positive(const Eigen::Vector3d& axis);

/// Seen along -up: the whole of `points` (1st to 99th percentile) fits into width x height with a margin. To the right goes
/// the direction in which walls run, the longer of the two. Points that are
/// not finite are left out; without points a metre around the origin is shown.
[[nodiscard]] Viewpoint fit_top_view(std::span<const Eigen::Vector3d> points, const Eigen::Vector3d& up, int width, int height,
                                     int margin_px);
/// Seen horizontally, up is up; looks into the top view's picture from its lower edge, with the same direction to the right.
[[nodiscard]] Viewpoint fit_side_view(std::span<const Eigen::Vector3d> points, const Eigen::Vector3d& up, int width, int height,
                                      int margin_px);
/// Seen from above and aside in perspective.
[[nodiscard]] Viewpoint fit_perspective_view(std::span<const Eigen::Vector3d> points, const Eigen::Vector3d& up, int width, int height,
                                             int margin_px);

/// A picture with a depth buffer. What falls outside is cut off; coordinates that are not finite draw nothing.
class PointRaster {
 public:
  PointRaster(int width, int height, Rgb background);
  /// Dots; the nearest to the eye is seen. One colour for all, or one per point. A radius up to 0.5 is a single pixel.
  void add_points(const Viewpoint& view, std::span<const Eigen::Vector3d> points, std::span<const Rgb> colors, double radius_px);
  void add_points(const Viewpoint& view, std::span<const Eigen::Vector3d> points, Rgb color, double radius_px) {
    add_points(view, points, std::span<const Rgb>(&color, 1), radius_px);
  }
  /// A polyline over everything that was drawn before.
  void add_line(const Viewpoint& view, std::span<const Eigen::Vector3d> line, Rgb color, double width_px);
  /// A camera as a small pyramid, drawn with lines.
  void add_camera(const Viewpoint& view, const Rigid3& T_world_camera, double size_m, Rgb color);
  /// As many of them as stand `spacing_px` apart in the picture, the first come first.
  void add_cameras(const Viewpoint& view, std::span<const Rigid3> T_world_camera, double spacing_px, double size_m, Rgb color);
  /// As in drawing.h.
  void add_text(int u, int v, const std::string& text, double height_px, Rgb color) {
    tools::draw_text(&image_, u, v, text, height_px, color);
  }
  [[nodiscard]] static int text_width(const std::string& text, double height_px) { return tools::text_width(text, height_px); }
  void add_rectangle(int u, int v, int width, int height, Rgb color) { tools::draw_rectangle(&image_, u, v, width, height, color); }
  /// A bar of a round length, at most a fifth of the picture, with its label; orthographic views. (u, v) is its left end.
  void add_scale_bar(const Viewpoint& view, int u, int v, Rgb color);
  /// A colour ramp with labels below both ends; 12 px high plus 22 px of labels. (u, v) is its upper left corner.
  void add_legend(int u, int v, int width, const std::string& low, const std::string& high, std::span<const Rgb> ramp);
  [[nodiscard]] const ColorImage& image() const { return image_; }

 private:
  ColorImage image_;
  std::vector<float> depth_;
};

/// Perceptually even ramp (256 entries) for values, from dark blue over green to bright yellow: its lightness grows evenly, so
/// it is readable without red-green vision and in grey.
[[nodiscard]] std::span<const Rgb> value_ramp();

}  // namespace camloc::mapping
