// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "tools/camloc-camera/calibration.h"

namespace camloc::camera_tool {
namespace {

constexpr std::size_t kMinToHoldOut = 16, kHoldOutStep = 4;
constexpr double kAngleScale_rad = 0.35, kDistanceScale = 0.35;  // a view that differs by this much says something new

/// Where the board stood, roughly: the lens is not known yet, so a typical one is taken.
struct Stand {
  Eigen::Vector3d normal;
  double log_distance;
};

std::optional<Stand> stand_of(const Board& board, const BoardCorners& corners, int width, int height) {
  const double focal_px = 0.85 * width;
  const Intrinsics typical{width, height, focal_px, focal_px, 0.5 * (width - 1), 0.5 * (height - 1)};
  const Result<Rigid3> T_camera_board = find_board(board, corners, typical);
  if (!T_camera_board) return std::nullopt;
  Eigen::Vector3d normal = T_camera_board->rotation * Eigen::Vector3d::UnitZ();
  if (normal.z() < 0) normal = -normal;
  return Stand{normal, std::log(T_camera_board->translation.norm())};
}

double difference(const Stand& a, const Stand& b) {
  const double angle_rad = std::acos(std::clamp(a.normal.dot(b.normal), -1.0, 1.0));
  return std::min(1.0, angle_rad / kAngleScale_rad + std::abs(a.log_distance - b.log_distance) / kDistanceScale);
}

/// What the view would add: corners in cells that have few, and a stand unlike the ones chosen.
double gain(const CoverageGrid& grid, const BoardCorners& corners, const std::optional<Stand>& stand, const std::vector<Stand>& chosen) {
  double cells = 0;
  for (const Eigen::Vector2d& pixel : corners.pixels) cells += 1.0 / (1.0 + grid.counts[grid.cell_of(pixel)]);
  if (!stand) return cells;
  double novelty = 1;
  for (const Stand& other : chosen) novelty = std::min(novelty, difference(*stand, other));
  return cells + 0.3 * static_cast<double>(corners.pixels.size()) * novelty;
}

}  // namespace

bool is_new_view(const BoardCorners& corners, std::span<const BoardView> views, double min_shift_px) {
  std::map<int, Eigen::Vector2d> by_id;
  for (std::size_t i = 0; i < corners.ids.size(); ++i) by_id[corners.ids[i]] = corners.pixels[i];
  return std::all_of(views.begin(), views.end(), [&](const BoardView& view) {
    double sum_px = 0;
    std::size_t num_common = 0;
    for (std::size_t i = 0; i < view.corners.ids.size(); ++i) {
      const auto found = by_id.find(view.corners.ids[i]);
      if (found == by_id.end()) continue;
      ++num_common;
      sum_px += (found->second - view.corners.pixels[i]).norm();
    }
    return 2 * num_common < corners.ids.size() || sum_px > min_shift_px * static_cast<double>(num_common);
  });
}

ViewChoice choose_views(const Board& board, std::span<const BoardView> views, int width, int height, std::size_t max_fit,
                        std::size_t max_held_out) {
  ViewChoice choice;
  std::vector<std::size_t> candidates;
  std::vector<std::optional<Stand>> stands;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const bool is_held_out = views.size() >= kMinToHoldOut && i % kHoldOutStep == kHoldOutStep / 2 && choice.held_out.size() < max_held_out;
    (is_held_out ? choice.held_out : candidates).push_back(i);
    stands.push_back(stand_of(board, views[i].corners, width, height));
  }
  CoverageGrid grid{width, height};
  std::vector<Stand> chosen;
  while (!candidates.empty() && choice.fit.size() < max_fit) {
    const auto best = std::max_element(candidates.begin(), candidates.end(), [&](std::size_t a, std::size_t b) {
      return gain(grid, views[a].corners, stands[a], chosen) < gain(grid, views[b].corners, stands[b], chosen);
    });
    choice.fit.push_back(*best);
    grid.add(views[*best].corners);
    if (stands[*best]) chosen.push_back(*stands[*best]);
    candidates.erase(best);
  }
  return choice;
}

std::size_t CoverageGrid::cell_of(const Eigen::Vector2d& pixel) const {
  const int column = std::clamp(static_cast<int>((pixel.x() + 0.5) * kColumns / width), 0, kColumns - 1);
  const int row = std::clamp(static_cast<int>((pixel.y() + 0.5) * kRows / height), 0, kRows - 1);
  return static_cast<std::size_t>(row * kColumns + column);
}

void CoverageGrid::add(const BoardCorners& corners) {
  for (const Eigen::Vector2d& pixel : corners.pixels) ++counts[cell_of(pixel)];
}

double CoverageGrid::covered() const {
  const auto num_covered = std::count_if(counts.begin(), counts.end(), [](int count) { return count > 0; });
  return static_cast<double>(num_covered) / static_cast<double>(counts.size());
}

std::string CoverageGrid::bare_sides() const {
  int left = 0, right = 0, top = 0, bottom = 0;
  const auto is_covered = [this](int column, int row) { return counts[static_cast<std::size_t>(row * kColumns + column)] > 0 ? 1 : 0; };
  for (int row = 0; row < kRows; ++row) left += is_covered(0, row), right += is_covered(kColumns - 1, row);
  for (int column = 0; column < kColumns; ++column) top += is_covered(column, 0), bottom += is_covered(column, kRows - 1);
  std::string text;
  const std::pair<const char*, bool> sides[] = {
      {"left", 2 * left < kRows}, {"right", 2 * right < kRows}, {"top", 2 * top < kColumns}, {"bottom", 2 * bottom < kColumns}};
  for (const auto& [name, is_bare] : sides) {
    if (is_bare) text += std::string(text.empty() ? "" : ", ") + "the " + name;
  }
  return text;
}

}  // namespace camloc::camera_tool
