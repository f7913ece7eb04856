// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/monitor/map_sketch.h"

#include <algorithm>
#include <cmath>

#include "core/base/order_statistics.h"
#include "tools/common/map_points.h"
#include "tools/common/text_format.h"

namespace camloc::tools {
namespace {

constexpr double kTail = 0.02;  // of the landmarks on each side, left out: a few are far outside
constexpr double kMinSize_m = 1;
constexpr std::size_t kMinLandmarksPerCell = 3;

/// What the landmarks, without the farthest, and all keyframes take up along one axis.
std::pair<double, double> extent(const std::vector<Eigen::Vector2d>& landmarks, const std::vector<Eigen::Vector2d>& keyframes, int axis) {
  std::vector<double> values;
  for (const Eigen::Vector2d& p : landmarks) values.push_back(p[axis]);
  double low = values.empty() ? keyframes.front()[axis] : lower_quantile(values, kTail),
         high = values.empty() ? low : lower_quantile(values, 1 - kTail);
  for (const Eigen::Vector2d& p : keyframes) {
    low = std::min(low, p[axis]);
    high = std::max(high, p[axis]);
  }
  const double missing_m = std::max(0.0, kMinSize_m - (high - low));
  return {low - 0.5 * missing_m, high + 0.5 * missing_m};
}

char arrow(const Eigen::Vector2d& forward) {
  if (forward.norm() < 0.3) return '+';  // it looks up or down
  if (std::abs(forward.x()) > std::abs(forward.y())) return forward.x() > 0 ? '>' : '<';
  return forward.y() > 0 ? '^' : 'v';
}

}  // namespace

MapSketch::MapSketch(const std::vector<Eigen::Vector2d>& landmarks, const std::vector<Eigen::Vector2d>& keyframes, int max_columns,
                     int max_rows) {
  if (keyframes.empty()) return;
  const auto [left, right] = extent(landmarks, keyframes, 0);
  const auto [bottom, top] = extent(landmarks, keyframes, 1);
  low_ = {left, bottom};
  column_m_ = std::max((right - left) / (max_columns - 1), (top - bottom) / (2.0 * (max_rows - 1)));
  const int num_columns = 1 + static_cast<int>((right - left) / column_m_),
            num_rows = 1 + static_cast<int>((top - bottom) / (2 * column_m_));
  rows_.assign(static_cast<std::size_t>(num_rows), std::string(static_cast<std::size_t>(num_columns), ' '));
  std::vector<std::vector<std::size_t>> counts(rows_.size(), std::vector<std::size_t>(rows_[0].size()));
  for (const Eigen::Vector2d& p : landmarks) {
    if (p.x() < left || p.x() > right || p.y() < bottom || p.y() > top) continue;
    const Cell cell = cell_of(p);
    const auto row = static_cast<std::size_t>(cell.row), column = static_cast<std::size_t>(cell.column);
    if (++counts[row][column] >= kMinLandmarksPerCell) rows_[row][column] = '.';
  }
  for (const Eigen::Vector2d& p : keyframes) {
    const Cell cell = cell_of(p);
    rows_[static_cast<std::size_t>(cell.row)][static_cast<std::size_t>(cell.column)] = 'o';
  }
}

MapSketch MapSketch::of(const MapView& map, int max_columns, int max_rows) {
  std::vector<Eigen::Vector2d> landmarks, keyframes;
  for (const Eigen::Vector3d& p : landmark_positions(map)) landmarks.emplace_back(p.head<2>());
  for (std::uint32_t k = 0; k < map.info().num_keyframes; ++k) keyframes.emplace_back(map.keyframe_pose(k).translation.head<2>());
  return MapSketch(landmarks, keyframes, max_columns, max_rows);
}

MapSketch::Cell MapSketch::cell_of(const Eigen::Vector2d& p) const {
  const double columns = (p.x() - low_.x()) / column_m_, rows = (p.y() - low_.y()) / (2 * column_m_);
  const auto last_column = static_cast<double>(rows_[0].size() - 1), last_row = static_cast<double>(rows_.size() - 1);
  return {static_cast<int>(std::clamp(columns, 0.0, last_column)),
          static_cast<int>(last_row - std::floor(std::clamp(rows, 0.0, last_row)))};
}

std::string MapSketch::draw(const std::optional<Rigid3>& T_map_camera) const {
  if (rows_.empty()) return "";
  std::vector<std::string> rows = rows_;
  if (T_map_camera && T_map_camera->translation.allFinite()) {
    const Cell cell = cell_of(T_map_camera->translation.head<2>());
    const Eigen::Vector3d forward = T_map_camera->rotation * Eigen::Vector3d::UnitZ();
    rows[static_cast<std::size_t>(cell.row)][static_cast<std::size_t>(cell.column)] = arrow(forward.head<2>());
  }
  std::string text;
  for (const std::string& row : rows) text += "  " + row + "\n";
  append_text(&text, "  %.1f x %.1f m, a column is %.2f m; x to the right, y up; . landmarks, o keyframes, ^>v< camera\n",
              column_m_ * static_cast<double>(rows_[0].size()), 2 * column_m_ * static_cast<double>(rows_.size()), column_m_);
  return text;
}

}  // namespace camloc::tools
