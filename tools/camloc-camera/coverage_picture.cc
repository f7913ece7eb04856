// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The picture that belongs to a calibration: where in the image corners were, and by how much they miss.

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "tools/camloc-camera/calibration.h"
#include "tools/common/text_format.h"

namespace camloc::camera_tool {
namespace {

constexpr int kMinWidth = 1200, kLegendHeight = 110;
constexpr double kErrorScale = 100;
// Red, green, blue: the picture is never shown by OpenCV.
const cv::Scalar kCorner(70, 160, 255), kHeldOut(120, 230, 120), kDropped(160, 160, 160), kError(255, 90, 60), kText(235, 235, 235),
    kGrid(70, 70, 70);

class Canvas {
 public:
  Canvas(int width, int height)
      : scale_(std::max(1.0, static_cast<double>(kMinWidth) / width)),
        size_(static_cast<int>(width * scale_), static_cast<int>(height * scale_)),
        image_(size_.height + kLegendHeight, size_.width, CV_8UC3, cv::Scalar(24, 24, 28)) {}

  void shade_cells(const CoverageGrid& grid) {
    const int most = std::max(1, *std::max_element(grid.counts.begin(), grid.counts.end()));
    for (int row = 0; row < CoverageGrid::kRows; ++row) {
      for (int column = 0; column < CoverageGrid::kColumns; ++column) {
        const int count = grid.counts[static_cast<std::size_t>(row * CoverageGrid::kColumns + column)];
        const cv::Rect cell(cell_corner(column, row), cell_corner(column + 1, row + 1));
        const double share = static_cast<double>(count) / most;
        const cv::Scalar color = count == 0 ? cv::Scalar(90, 30, 30) : cv::Scalar(28 + 10 * share, 34 + 50 * share, 46 + 70 * share);
        cv::rectangle(image_, cell, color, cv::FILLED);
        cv::rectangle(image_, cell, kGrid, 1);
        write(std::to_string(count), {cell.x + 5, cell.y + 16}, 0.42, kDropped);
      }
    }
  }
  void draw_corners(const BoardCorners& corners, const std::vector<Eigen::Vector2d>& errors_px, const cv::Scalar& color) {
    for (std::size_t i = 0; i < corners.pixels.size(); ++i) {
      if (i < errors_px.size())
        cv::line(image_, to_canvas(corners.pixels[i]), to_canvas(corners.pixels[i] + kErrorScale / scale_ * errors_px[i]), kError, 1,
                 cv::LINE_AA);
      cv::circle(image_, to_canvas(corners.pixels[i]), 2, color, cv::FILLED, cv::LINE_AA);
    }
  }
  void draw_principal_point(const Intrinsics& k) {
    cv::drawMarker(image_, to_canvas({k.cx, k.cy}), kText, cv::MARKER_CROSS, 24, 1, cv::LINE_AA);
  }
  void write_legend(int line, const std::string& text, const cv::Scalar& color) {
    write(text, {12, size_.height + 24 + 24 * line}, 0.55, color);
  }
  [[nodiscard]] ColorImage take() const {
    ColorImage image{std::vector<std::uint8_t>(image_.total() * 3), image_.cols, image_.rows};
    std::copy_n(image_.ptr<std::uint8_t>(), image.pixels.size(), image.pixels.begin());
    return image;
  }

 private:
  [[nodiscard]] cv::Point to_canvas(const Eigen::Vector2d& pixel) const {
    return {static_cast<int>((pixel.x() + 0.5) * scale_), static_cast<int>((pixel.y() + 0.5) * scale_)};
  }
  [[nodiscard]] cv::Point cell_corner(int column, int row) const {
    return {column * size_.width / CoverageGrid::kColumns, row * size_.height / CoverageGrid::kRows};
  }
  void write(const std::string& text, const cv::Point& at, double size, const cv::Scalar& color) {
    cv::putText(image_, text, at, cv::FONT_HERSHEY_SIMPLEX, size, color, 1, cv::LINE_AA);
  }

  double scale_;
  cv::Size size_;
  cv::Mat image_;
};

}  // namespace

ColorImage draw_coverage(const Board& board, const Calibration& calibration, const CalibrationViews& views) {
  const LensFit& fit = calibration.lens;
  const Intrinsics& k = fit.intrinsics;
  Canvas canvas(k.width, k.height);
  canvas.shade_cells(calibration.grid);
  for (const std::size_t view : fit.dropped) canvas.draw_corners(views.views[view].corners, {}, kDropped);
  for (const std::size_t view : calibration.held_out) canvas.draw_corners(views.views[view].corners, {}, kHeldOut);
  for (std::size_t i = 0; i < fit.used.size(); ++i) {
    const BoardCorners& corners = views.views[fit.used[i]].corners;
    canvas.draw_corners(corners, reprojection_errors(board, corners, k, fit.T_camera_board[i]), kCorner);
  }
  canvas.draw_principal_point(k);
  canvas.write_legend(
      0,
      tools::text_of("blue: %zu views, rms %.3f px; red: errors, 1 px drawn %.0f px long; numbers: corners in a cell, %.0f %% of the cells",
                     fit.used.size(), fit.rms_px, kErrorScale, 100 * calibration.grid.covered()),
      kCorner);
  canvas.write_legend(1, tools::text_of("green: %zu views held out", calibration.held_out.size()), kHeldOut);
  canvas.write_legend(2, tools::text_of("grey: %zu views dropped because they do not fit the others", fit.dropped.size()), kDropped);
  canvas.write_legend(3, tools::text_of("cross: principal point %.1f %.1f; fx %.2f fy %.2f", k.cx, k.cy, k.fx, k.fy), kText);
  return canvas.take();
}

}  // namespace camloc::camera_tool
