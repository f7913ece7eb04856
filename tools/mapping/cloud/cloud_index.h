// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Nearest points of a cloud, and the surface around them.
// And cells, over which points are slid to find where most of them land on one (cell_correlation.cc).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace camloc::mapping {

/// A k-d tree over points that somebody else keeps alive. Planes are fitted when they are first asked for and kept: not
/// thread-safe.
class CloudIndex {
 public:
  explicit CloudIndex(std::span<const Eigen::Vector3f> points_m);
  ~CloudIndex();

  struct Neighbor {
    std::uint32_t index = 0;
    double distance_m = 0;
  };
  /// The local surface at a point of the cloud.
  struct Plane {
    Eigen::Vector3d point_m;  ///< on it: the middle of the neighbours, or the point itself where they are no plane
    Eigen::Vector3d normal;   ///< unit; the sign means nothing
    bool is_flat = false;     ///< the neighbours lie in a plane: thickness below a third of their width
  };

  [[nodiscard]] std::span<const Eigen::Vector3f> points_m() const;
  /// Nothing without points, or where none is within max_distance_m.
  [[nodiscard]] std::optional<Neighbor> nearest(const Eigen::Vector3d& p_m, double max_distance_m) const;
  /// By principal components of the points within 8 cm, or of the nearest dozen where those are fewer.
  [[nodiscard]] const Plane& plane_at(std::uint32_t index);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A rotation whose columns are the direction that most surfaces face, the one across it that most of the others face, and the
/// third. Surfaces are planes through neighbouring points, which are about a decimetre apart. Principal axes of the points
/// where there are no surfaces.
[[nodiscard]] Eigen::Matrix3d wall_directions(const std::vector<Eigen::Vector3d>& points_m);

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
  void score_row(const std::vector<Eigen::Array3i>& points, int ty, int tz, int first_x, std::vector<std::uint16_t>* scores) const;

  double cell_m_ = 0;
  Eigen::Vector3d low_m_ = Eigen::Vector3d::Zero();
  Eigen::Array3i size_ = Eigen::Array3i::Zero();
  std::vector<std::uint8_t> cells_;  ///< 2 occupied, 1 beside one, x fastest
};

}  // namespace camloc::mapping
