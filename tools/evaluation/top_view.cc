// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/evaluation/top_view.h"

#include <algorithm>

#include "core/base/order_statistics.h"
#include "core/io/image_writer.h"
#include "tools/common/drawing.h"
#include "tools/common/map_points.h"
#include "tools/common/text_format.h"

namespace camloc::tools {
namespace {

// Colours are RGB; the palette keeps apart for colour-blind readers (blue, orange, grey).
constexpr Rgb kBackground{252, 252, 250}, kInk{40, 40, 46}, kLandmark{168, 172, 180};
constexpr Rgb kTruth{30, 30, 34}, kGood{0, 114, 178}, kFair{230, 159, 0}, kBad{213, 60, 40}, kKeyframe{120, 160, 120};
constexpr int kWidthPx = 1200, kMargin = 50, kHeader = 70, kFooter = 60;
constexpr double kTextPx = 10, kTitlePx = 12.5;
constexpr double kGoodM = 0.05, kFairM = 0.25;

/// Map axes to picture: which axis is up, and where a metre lands.
struct Projection {
  int right = 0, up = 1;  ///< map axes drawn to the right and upwards
  double min_right = 0, min_up = 0, px_per_m = 1;
  int height_px = 0;

  [[nodiscard]] Eigen::Vector2d operator()(const Eigen::Vector3d& p) const {
    return {kMargin + (p[right] - min_right) * px_per_m, height_px - kFooter - (p[up] - min_up) * px_per_m};
  }
};

Projection fit(const std::vector<Eigen::Vector3d>& landmarks, const std::vector<Rigid3>& truth, const std::vector<Rigid3>& estimate) {
  std::pair<double, double> range[3];
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const auto& p : landmarks) values.push_back(p[axis]);
    range[axis] = {0, 1};
    auto& [low, high] = range[axis];
    // From the 1st to the 99th percentile: a few far landmarks must not shrink the picture.
    if (!values.empty()) range[axis] = trimmed_range(std::move(values), 100);
    for (const auto* poses : {&truth, &estimate}) {
      for (const Rigid3& pose : *poses) {
        low = std::min(low, pose.translation[axis]);
        high = std::max(high, pose.translation[axis]);
      }
    }
  }
  const auto extent = [&](int axis) { return range[axis].second - range[axis].first; };
  int flat = 0;
  for (int axis = 1; axis < 3; ++axis)
    if (extent(axis) < extent(flat)) flat = axis;
  Projection projection;
  projection.right = flat == 0 ? 1 : 0;
  projection.up = flat == 2 ? 1 : 2;
  if (extent(projection.up) > extent(projection.right)) std::swap(projection.right, projection.up);
  projection.min_right = range[projection.right].first;
  projection.min_up = range[projection.up].first;
  projection.px_per_m = (kWidthPx - 2 * kMargin) / std::max(0.1, extent(projection.right));
  projection.height_px = kHeader + kFooter + static_cast<int>(extent(projection.up) * projection.px_per_m) + 1;
  return projection;
}

void draw_scale_bar(ColorImage* canvas, const Projection& projection) {
  double length_m = 0.1;
  for (const double step : {0.25, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0})
    if (step * projection.px_per_m < canvas->width * 0.25) length_m = step;
  const int length_px = static_cast<int>(length_m * projection.px_per_m), v = canvas->height - 22;
  draw_rectangle(canvas, kMargin, v - 1, length_px, 2, kInk);
  draw_text(canvas, kMargin + length_px + 8, v + 5, text_of("%g m", length_m), kTextPx, kInk);
}

void draw_legend(ColorImage* canvas) {
  const std::pair<const char*, Rgb> entries[] = {{"landmark", kLandmark},    {"keyframe", kKeyframe}, {"truth", kTruth},
                                                 {"estimate < 5 cm", kGood}, {"< 25 cm", kFair},      {"farther", kBad}};
  int u = kMargin;
  for (const auto& [text, color] : entries) {
    draw_disc(canvas, {u, 50}, 5.5, color);
    draw_text(canvas, u + 11, 55, text, kTextPx, kInk);
    u += 36 + text_width(text, kTextPx);
  }
}

void draw_keyframe(ColorImage* canvas, const Eigen::Vector2d& at) {
  const std::array<Eigen::Vector2d, 4> corner = {{{-4, -4}, {4, -4}, {4, 4}, {-4, 4}}};
  for (std::size_t i = 0; i < 4; ++i) draw_line(canvas, at + corner[i], at + corner[(i + 1) % 4], kKeyframe, 1);
}

void draw_estimate(ColorImage* canvas, const TopView& view, const Projection& projection) {
  for (std::size_t i = 0; i < view.estimate.size(); ++i) {
    const Rigid3& pose = view.estimate[i];
    Rgb color = kGood;
    if (i < view.error_m.size() && view.error_m[i] > kGoodM) color = view.error_m[i] > kFairM ? kBad : kFair;
    const Eigen::Vector2d at = projection(pose.translation);
    const Eigen::Vector3d ahead = pose.translation + pose.rotation * Eigen::Vector3d(0, 0, 16.0 / projection.px_per_m);
    draw_line(canvas, at, projection(ahead), color, 1);
    draw_disc(canvas, at, 5.5, kBackground);  // a rim, so that dots on the line stay apart
    draw_disc(canvas, at, 4.5, color);
  }
}

}  // namespace

Status write_top_view(const TopView& view, const std::string& path) {
  const std::vector<Eigen::Vector3d> landmarks = view.map == nullptr ? std::vector<Eigen::Vector3d>() : landmark_positions(*view.map);
  const Projection projection = fit(landmarks, view.truth, view.estimate);
  ColorImage canvas = blank_image(kWidthPx, projection.height_px, kBackground);
  for (const auto& p : landmarks) {
    const Eigen::Vector2d at = projection(p);
    // Far landmarks must not run into the title and the scale.
    if (at.y() >= kHeader && at.y() < canvas.height - kFooter / 2 - 8) draw_disc(&canvas, at, 1.3, kLandmark);
  }
  if (view.map != nullptr) {
    for (std::uint32_t i = 0; i < view.map->keyframes().size(); ++i) {
      draw_keyframe(&canvas, projection(view.map->keyframe_pose(i).translation));
    }
  }
  for (std::size_t i = 1; i < view.truth.size(); ++i) {
    // A line across a gap would show a motion that nobody made.
    if ((view.truth[i].translation - view.truth[i - 1].translation).norm() > 1.0) continue;
    draw_line(&canvas, projection(view.truth[i - 1].translation), projection(view.truth[i].translation), kTruth, 2);
  }
  draw_estimate(&canvas, view, projection);
  draw_text(&canvas, kMargin, 28, view.title, kTitlePx, kInk);
  draw_legend(&canvas);
  draw_scale_bar(&canvas, projection);
  return write_png(path, canvas);
}

}  // namespace camloc::tools
