// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Points go through a depth buffer; lines and text are drawn over everything.
#include "tools/mapping/picture/point_raster.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "tools/common/text_format.h"

namespace camloc::mapping {
namespace {

constexpr double kNearM = 0.05;       // perspective: what is closer to the eye is not drawn
constexpr double kTextHeightPx = 11;  // of labels
constexpr int kMaxLinePx = 1 << 14;   // what is farther outside is not worth a line

/// Pixel and distance along the view's axis, or nothing behind the eye.
std::optional<Eigen::Vector3d> project(const Viewpoint& view, const Eigen::Vector3d& p_view) {
  if (view.is_perspective && !(p_view.z() > kNearM)) return std::nullopt;
  const Eigen::Vector2d pixel = view.pixel_of(p_view);
  return Eigen::Vector3d(pixel.x(), pixel.y(), p_view.z());
}

bool is_drawable(const Eigen::Vector3d& pixel) { return pixel.allFinite() && pixel.head<2>().cwiseAbs().maxCoeff() < kMaxLinePx; }

/// The shortest disc of pixel offsets that reads as a dot of `radius_px`.
std::vector<Eigen::Vector2i> disc(double radius_px) {
  std::vector<Eigen::Vector2i> offsets;
  const int reach = std::max(0, static_cast<int>(std::ceil(radius_px - 0.5)));
  for (int y = -reach; y <= reach; ++y) {
    for (int x = -reach; x <= reach; ++x) {
      if (x * x + y * y <= radius_px * radius_px || (x == 0 && y == 0)) offsets.emplace_back(x, y);
    }
  }
  return offsets;
}

std::uint8_t to_srgb_byte(double linear) {
  const double clipped = std::clamp(linear, 0.0, 1.0);
  const double srgb = clipped <= 0.0031308 ? 12.92 * clipped : 1.055 * std::pow(clipped, 1 / 2.4) - 0.055;
  return static_cast<std::uint8_t>(std::lround(255 * srgb));
}

/// CIE lightness, chroma and hue (degrees; white D65) to linear RGB, unclipped.
Eigen::Vector3d linear_rgb(double lightness, double chroma, double hue_deg) {
  const double hue = hue_deg * std::numbers::pi / 180;
  const auto inverse_f = [](double t) { return t > 6.0 / 29 ? t * t * t : 3 * (6.0 / 29) * (6.0 / 29) * (t - 4.0 / 29); };
  const double fy = (lightness + 16) / 116;
  const Eigen::Vector3d xyz(0.95047 * inverse_f(fy + chroma * std::cos(hue) / 500), inverse_f(fy),
                            1.08883 * inverse_f(fy - chroma * std::sin(hue) / 200));
  Eigen::Matrix3d rgb_from_xyz;
  rgb_from_xyz << 3.2406, -1.5372, -0.4986, -0.9689, 1.8758, 0.0415, 0.0557, -0.2040, 1.0570;
  return rgb_from_xyz * xyz;
}

/// Lightness grows evenly from a dark blue over green to yellow, as saturated as a screen can show it.
std::array<Rgb, 256> make_value_ramp() {
  std::array<Rgb, 256> ramp{};
  for (std::size_t i = 0; i < ramp.size(); ++i) {
    const double t = static_cast<double>(i) / 255;
    const double lightness = 18 + 74 * t, hue_deg = 290 - 195 * std::pow(t, 0.9);
    double chroma = 75;
    Eigen::Vector3d rgb = linear_rgb(lightness, chroma, hue_deg);
    while (chroma > 0 && (rgb.minCoeff() < 0 || rgb.maxCoeff() > 1)) rgb = linear_rgb(lightness, chroma -= 1, hue_deg);
    ramp[i] = {to_srgb_byte(rgb[0]), to_srgb_byte(rgb[1]), to_srgb_byte(rgb[2])};
  }
  return ramp;
}

}  // namespace

PointRaster::PointRaster(int width, int height, Rgb background) : image_(tools::blank_image(width, height, background)) {
  depth_.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), std::numeric_limits<float>::infinity());
}

void PointRaster::add_points(const Viewpoint& view, std::span<const Eigen::Vector3d> points, std::span<const Rgb> colors,
                             double radius_px) {
  if (colors.empty()) return;
  const std::vector<Eigen::Vector2i> dot = disc(radius_px);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto pixel = project(view, view.T_view_world * points[i]);
    if (!pixel || !is_drawable(*pixel)) continue;
    const Rgb color = colors[colors.size() == 1 ? 0 : std::min(i, colors.size() - 1)];
    const int u = static_cast<int>(std::lround(pixel->x())), v = static_cast<int>(std::lround(pixel->y()));
    const auto depth = static_cast<float>(pixel->z());
    for (const Eigen::Vector2i& offset : dot) {
      const int x = u + offset.x(), y = v + offset.y();
      if (x < 0 || y < 0 || x >= image_.width || y >= image_.height) continue;
      const std::size_t at = static_cast<std::size_t>(y) * static_cast<std::size_t>(image_.width) + static_cast<std::size_t>(x);
      if (depth >= depth_[at]) continue;
      depth_[at] = depth;
      std::copy(color.begin(), color.end(), image_.pixels.begin() + static_cast<std::ptrdiff_t>(3 * at));
    }
  }
}

void PointRaster::add_line(const Viewpoint& view, std::span<const Eigen::Vector3d> line, Rgb color, double width_px) {
  for (std::size_t i = 1; i < line.size(); ++i) {
    Eigen::Vector3d from = view.T_view_world * line[i - 1], to = view.T_view_world * line[i];
    if (view.is_perspective) {  // cut at the near plane
      if (from.z() > to.z()) std::swap(from, to);
      if (!(to.z() > kNearM)) continue;
      if (from.z() <= 1.01 * kNearM) from += (to - from) * std::min(1.0, (1.01 * kNearM - from.z()) / std::max(1e-9, to.z() - from.z()));
    }
    const auto a = project(view, from), b = project(view, to);
    if (!a || !b || !is_drawable(*a) || !is_drawable(*b)) continue;
    tools::draw_line(&image_, a->head<2>(), b->head<2>(), color, std::max(1.0, width_px));
  }
}

void PointRaster::add_camera(const Viewpoint& view, const Rigid3& T_world_camera, double size_m, Rgb color) {
  std::array<Eigen::Vector3d, 5> corners;
  corners[0] = T_world_camera.translation;
  constexpr double kX[] = {-0.5, 0.5, 0.5, -0.5}, kY[] = {-0.375, -0.375, 0.375, 0.375};
  for (std::size_t i = 0; i < 4; ++i) corners[i + 1] = T_world_camera * (size_m * Eigen::Vector3d(kX[i], kY[i], 0.7));
  for (const auto& [from, to] : {std::pair{0U, 1U}, {0U, 2U}, {0U, 3U}, {0U, 4U}, {1U, 2U}, {2U, 3U}, {3U, 4U}, {4U, 1U}}) {
    add_line(view, std::array{corners[from], corners[to]}, color, 1);
  }
}

void PointRaster::add_cameras(const Viewpoint& view, std::span<const Rigid3> T_world_camera, double spacing_px, double size_m, Rgb color) {
  std::vector<Eigen::Vector2d> drawn;
  for (const Rigid3& T : T_world_camera) {
    const Eigen::Vector2d at = view.pixel_of(view.T_view_world * T.translation);
    if (std::any_of(drawn.begin(), drawn.end(), [&](const Eigen::Vector2d& other) { return (other - at).norm() < spacing_px; })) continue;
    drawn.push_back(at);
    add_camera(view, T, size_m, color);
  }
}

void PointRaster::add_scale_bar(const Viewpoint& view, int u, int v, Rgb color) {
  const double limit_m = 0.2 * image_.width / view.px_per_m;
  if (!(limit_m > 1e-6) || !(limit_m < 1e9)) return;
  const double decade = std::pow(10.0, std::floor(std::log10(limit_m)));
  double length_m = decade;
  for (const double step : {2.0, 5.0})
    if (step * decade <= limit_m) length_m = step * decade;
  const int length_px = static_cast<int>(std::lround(length_m * view.px_per_m));
  add_rectangle(u, v - 1, length_px, 3, color);
  add_rectangle(u, v - 5, 2, 11, color);
  add_rectangle(u + length_px - 2, v - 5, 2, 11, color);
  const std::string label = length_m < 0.01 ? tools::text_of("%g mm", 1000 * length_m)
                            : length_m < 1  ? tools::text_of("%g cm", 100 * length_m)
                                            : tools::text_of("%g m", length_m);
  add_text(u + length_px + 8, v + static_cast<int>(kTextHeightPx) / 2, label, kTextHeightPx, color);
}

void PointRaster::add_legend(int u, int v, int width, const std::string& low, const std::string& high, std::span<const Rgb> ramp) {
  constexpr int kBarHeightPx = 12, kLabelDropPx = 17;
  if (ramp.empty() || width < 2) return;
  for (int x = 0; x < width; ++x) {
    const std::size_t entry = static_cast<std::size_t>(x) * (ramp.size() - 1) / static_cast<std::size_t>(width - 1);
    add_rectangle(u + x, v, 1, kBarHeightPx, ramp[entry]);
  }
  // The ink that can be read on this background: the picture's own corner decides.
  const int brightness = image_.pixels.empty() ? 0 : image_.pixels[0] + image_.pixels[1] + image_.pixels[2];
  const Rgb ink = brightness > 384 ? Rgb{40, 40, 46} : Rgb{225, 225, 228};
  add_text(u, v + kBarHeightPx + kLabelDropPx, low, kTextHeightPx, ink);
  add_text(u + width - text_width(high, kTextHeightPx), v + kBarHeightPx + kLabelDropPx, high, kTextHeightPx, ink);
}

std::span<const Rgb> value_ramp() {
  static const std::array<Rgb, 256> ramp = make_value_ramp();
  return ramp;
}

}  // namespace camloc::mapping
