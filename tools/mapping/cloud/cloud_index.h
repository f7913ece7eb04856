// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Nearest points of a cloud, and the surface around them.
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

}  // namespace camloc::mapping
