// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/evaluation/top_view.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "core/base/order_statistics.h"
#include "core/io/image_writer.h"
#include "tools/common/map_points.h"
#include "tools/common/text_format.h"

namespace camloc::tools {
namespace {

// Colours are RGB; the palette keeps apart for colour-blind readers (blue, orange, grey).
const cv::Scalar kBackground(252, 252, 250), kInk(40, 40, 46), kGrid(226, 226, 222), kLandmark(168, 172, 180);
const cv::Scalar kTruth(30, 30, 34), kGood(0, 114, 178), kFair(230, 159, 0), kBad(213, 60, 40), kKeyframe(120, 160, 120);
constexpr int kWidthPx = 1200, kMargin = 50, kHeader = 70, kFooter = 60;
constexpr double kGoodM = 0.05, kFairM = 0.25;

/// Map axes to picture: which axis is up, and where a metre lands.
struct Projection {
  int right = 0, up = 1;  ///< map axes drawn to the right and upwards
  double min_right = 0, min_up = 0, px_per_m = 1;
  int height_px = 0;

  [[nodiscard]] cv::Point operator()(const Eigen::Vector3d& p) const {
    return {kMargin + static_cast<int>(std::lround((p[right] - min_right) * px_per_m)),
            height_px - kFooter - static_cast<int>(std::lround((p[up] - min_up) * px_per_m))};
  }
};

/// 1st and 99th percentile of a coordinate: a few far landmarks must not shrink the picture.
std::pair<double, double> range_of(std::vector<double> values) {
  if (values.empty()) return {0, 1};
  return trimmed_range(std::move(values), 100);
}

Projection fit(const std::vector<Eigen::Vector3d>& landmarks, const std::vector<Rigid3>& truth, const std::vector<Rigid3>& estimate) {
  std::array<std::pair<double, double>, 3> range;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const auto& p : landmarks) values.push_back(p[axis]);
    range[static_cast<std::size_t>(axis)] = range_of(std::move(values));
    auto& [low, high] = range[static_cast<std::size_t>(axis)];
    for (const auto* poses : {&truth, &estimate}) {
      for (const Rigid3& pose : *poses) {
        low = std::min(low, pose.translation[axis]);
        high = std::max(high, pose.translation[axis]);
      }
    }
  }
  const auto extent = [&](int axis) { return range[static_cast<std::size_t>(axis)].second - range[static_cast<std::size_t>(axis)].first; };
  int flat = 0;
  for (int axis = 1; axis < 3; ++axis)
    if (extent(axis) < extent(flat)) flat = axis;
  Projection projection;
  projection.right = flat == 0 ? 1 : 0;
  projection.up = flat == 2 ? 1 : 2;
  if (extent(projection.up) > extent(projection.right)) std::swap(projection.right, projection.up);
  projection.min_right = range[static_cast<std::size_t>(projection.right)].first;
  projection.min_up = range[static_cast<std::size_t>(projection.up)].first;
  projection.px_per_m = (kWidthPx - 2 * kMargin) / std::max(0.1, extent(projection.right));
  projection.height_px = kHeader + kFooter + static_cast<int>(extent(projection.up) * projection.px_per_m) + 1;
  return projection;
}

void draw_text(cv::Mat& canvas, const std::string& text, cv::Point at, const cv::Scalar& color, double size = 0.5) {
  cv::putText(canvas, text, at, cv::FONT_HERSHEY_SIMPLEX, size, color, 1, cv::LINE_AA);
}

void draw_scale_bar(cv::Mat& canvas, const Projection& projection) {
  double length_m = 0.1;
  for (const double step : {0.25, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0})
    if (step * projection.px_per_m < canvas.cols * 0.25) length_m = step;
  const cv::Point from(kMargin, canvas.rows - 22);
  const cv::Point to = from + cv::Point(static_cast<int>(length_m * projection.px_per_m), 0);
  cv::line(canvas, from, to, kInk, 2);
  draw_text(canvas, text_of("%g m", length_m), to + cv::Point(8, 5), kInk);
}

void draw_legend(cv::Mat& canvas) {
  const struct {
    const char* text;
    cv::Scalar color;
  } entries[] = {{"landmark", kLandmark},    {"keyframe", kKeyframe}, {"truth", kTruth},
                 {"estimate < 5 cm", kGood}, {"< 25 cm", kFair},      {"farther", kBad}};
  int x = kMargin;
  for (const auto& entry : entries) {
    cv::circle(canvas, {x, 50}, 5, entry.color, cv::FILLED, cv::LINE_AA);
    draw_text(canvas, entry.text, {x + 11, 55}, kInk, 0.45);
    x += 36 + static_cast<int>(8.5 * static_cast<double>(std::string(entry.text).size()));
  }
}

void draw_estimate(cv::Mat& canvas, const TopView& view, const Projection& projection) {
  for (std::size_t i = 0; i < view.estimate.size(); ++i) {
    const Rigid3& pose = view.estimate[i];
    cv::Scalar color = kGood;
    if (i < view.error_m.size() && view.error_m[i] > kGoodM) color = view.error_m[i] > kFairM ? kBad : kFair;
    const cv::Point at = projection(pose.translation);
    const Eigen::Vector3d ahead = pose.translation + pose.rotation * Eigen::Vector3d(0, 0, 16.0 / projection.px_per_m);
    cv::line(canvas, at, projection(ahead), color, 1, cv::LINE_AA);
    cv::circle(canvas, at, 5, kBackground, cv::FILLED, cv::LINE_AA);  // a rim, so that dots on the line stay apart
    cv::circle(canvas, at, 4, color, cv::FILLED, cv::LINE_AA);
  }
}

}  // namespace

Status write_top_view(const TopView& view, const std::string& path) {
  const std::vector<Eigen::Vector3d> landmarks = view.map == nullptr ? std::vector<Eigen::Vector3d>() : landmark_positions(*view.map);
  const Projection projection = fit(landmarks, view.truth, view.estimate);
  cv::Mat canvas(projection.height_px, kWidthPx, CV_8UC3, kBackground);
  // Far landmarks must not run into the title and the scale.
  const cv::Rect plot(0, kHeader, canvas.cols, canvas.rows - kHeader - kFooter / 2 - 8);
  for (const auto& p : landmarks) {
    const cv::Point at = projection(p);
    if (plot.contains(at)) cv::circle(canvas, at, 1, kLandmark, cv::FILLED);
  }
  if (view.map != nullptr) {
    for (std::uint32_t i = 0; i < view.map->keyframes().size(); ++i) {
      cv::drawMarker(canvas, projection(view.map->keyframe_pose(i).translation), kKeyframe, cv::MARKER_SQUARE, 9, 1, cv::LINE_AA);
    }
  }
  for (std::size_t i = 1; i < view.truth.size(); ++i) {
    // A line across a gap would show a walk that nobody made.
    if ((view.truth[i].translation - view.truth[i - 1].translation).norm() > 1.0) continue;
    cv::line(canvas, projection(view.truth[i - 1].translation), projection(view.truth[i].translation), kTruth, 2, cv::LINE_AA);
  }
  draw_estimate(canvas, view, projection);
  draw_text(canvas, view.title, {kMargin, 28}, kInk, 0.6);
  draw_legend(canvas);
  draw_scale_bar(canvas, projection);
  return write_png(path, canvas.data, canvas.cols, canvas.rows, 3);
}

}  // namespace camloc::tools
