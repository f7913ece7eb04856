// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Slides points over the occupied cells of a grid and finds the translations at which most of them land on one.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace camloc::mapping {

class CellGrid {
 public:
  /// Cells of `cell_m`, or larger, so that there are at most `max_cells`.
  CellGrid(const std::vector<Eigen::Vector3d>& points_m, double cell_m, std::size_t max_cells);

  struct Place {
    Eigen::Vector3d translation_m;  ///< p_grid = p + translation_m
    double share = 0;               ///< of the points that land on or beside an occupied cell, on it counting twice; 0 to 1
  };
  /// The best translations, best first, no two within three cells of each other. At least half of the extent of the points along
  /// each axis overlaps the grid. The points are in the axes of the grid.
  [[nodiscard]] std::vector<Place> best_places(const std::vector<Eigen::Vector3d>& points_m, std::size_t max_places) const;

  [[nodiscard]] double cell_m() const { return cell_m_; }

 private:
  /// Scores of all x at one row of translations; `points` are cells relative to their lower corner.
  void score_row(const std::vector<std::array<int, 3>>& points, int ty, int tz, int first_x, std::vector<std::uint16_t>* scores) const;

  double cell_m_ = 0;
  Eigen::Vector3d low_m_ = Eigen::Vector3d::Zero();
  std::array<int, 3> size_{};
  std::vector<std::uint8_t> cells_;  ///< 2 occupied, 1 beside one, x fastest
};

}  // namespace camloc::mapping
