// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// How far the landmarks of a map are from a cloud, and how much of the cloud the map covers. One way alone deceives: a map that
// has shrunk to a point lies on the cloud perfectly.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "tools/mapping/cloud/cloud_index.h"

namespace camloc::mapping {

struct DistanceStatistics {
  std::uint64_t count = 0;
  double mean_m = 0, median_m = 0, rms_m = 0, p95_m = 0, max_m = 0;
  double share_3cm = 0, share_5cm = 0;  ///< of `count`
};
/// Of values that are not negative; the percentiles are values that occur.
[[nodiscard]] DistanceStatistics statistics_of(std::span<const float> values_m);

struct CloudDistances {
  std::vector<float> point_m;                                ///< per landmark: to the nearest point of the cloud, however far
  DistanceStatistics point;                                  ///< of landmarks within max_distance_m
  DistanceStatistics plane;                                  ///< of the same, to the surface around the nearest point
  DistanceStatistics all;                                    ///< to the nearest point, of all landmarks
  std::uint64_t num_outside = 0;                             ///< landmarks farther than max_distance_m
  std::uint64_t num_cells = 0, num_covered = 0;              ///< of the cloud: within the map's bounding box and near a keyframe
  DistanceStatistics cells;                                  ///< from those cells to the nearest landmark
  Eigen::Vector3d map_extent_m = Eigen::Vector3d::Zero();    ///< sides of the boxes (1st to 99th percentile) along the
  Eigen::Vector3d cloud_extent_m = Eigen::Vector3d::Zero();  ///< cloud's axes
  /// Map box over cloud box. Small: the map holds a part of the scan, or it has shrunk.
  [[nodiscard]] double volume_ratio() const;
};

/// All points in the frame of the cloud; a landmark farther from it than `max_distance_m` is outside of what was scanned.
[[nodiscard]] CloudDistances measure_distances(std::span<const Eigen::Vector3d> landmarks_m, std::span<const Eigen::Vector3d> keyframes_m,
                                               CloudIndex* cloud, double max_distance_m);

}  // namespace camloc::mapping
