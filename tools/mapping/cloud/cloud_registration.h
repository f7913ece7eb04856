// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Lays the points of a map onto a cloud: by trimmed iterative closest points, and without any hint.
// `map` is the frame of the landmarks, `cloud` that of a PointCloud relative to its origin.
// And how far landmarks are from a cloud, and how much of it the map covers (cloud_distance.cc). One way alone deceives: a map that
// has shrunk to a point lies on the cloud perfectly.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/result.h"
#include "core/geometry/rigid3.h"
#include "tools/mapping/cloud/cloud_index.h"

namespace camloc::mapping {

/// p_a = scale * rigid.rotation * p_b + rigid.translation.
struct Similarity3 {
  double scale = 1;
  Rigid3 rigid;
  [[nodiscard]] Eigen::Vector3d operator*(const Eigen::Vector3d& p) const { return scale * (rigid.rotation * p) + rigid.translation; }
};

struct RegistrationOptions {
  double trim = 0.9;              ///< share of the correspondences that is used, the closest
  double max_distance_m = 0.5;    ///< a neighbour farther away is no correspondence
  double start_distance_m = 0.5;  ///< the same at the beginning; shrinks to max_distance_m
  int max_iterations = 60;
  std::size_t max_points = 20000;  ///< evenly chosen from the landmarks
  bool has_scale = false;          ///< a seventh degree of freedom, for checking only
};

struct Registration {
  Similarity3 T_cloud_map;
  int num_iterations = 0;
  std::uint64_t num_points = 0, num_correspondences = 0;  ///< tried, and used in the last iteration
  double rms_m = 0;  ///< of the distances to the surface in the last iteration, with the weights of the robust kernel
  bool is_converged = false;
  double sigma_scale = 0;  ///< with has_scale: standard deviation, correspondences taken as independent
  /// Share of the correspondences whose surface stands across the direction in which the cloud holds the map least (0: it
  /// can slide along there freely; 1/3: equally in all directions), and that direction in the cloud's axes.
  double weakest_share = 0;
  Eigen::Vector3d weakest_direction = Eigen::Vector3d::Zero();
};

/// Iterative closest points, point to plane (Chen and Medioni, "Object modelling by registration of multiple range images",
/// 1992), trimmed (Chetverikov, Svirko, Stepanov, Krsek, "The trimmed iterative closest point algorithm", 2002), with Cauchy
/// weights whose width follows the residuals, solved by Gauss-Newton with a little damping; at the end some iterations without
/// trimming. kInvalid: fewer than ten correspondences within the distance.
[[nodiscard]] Result<Registration> register_points(std::span<const Eigen::Vector3d> points_map, CloudIndex* cloud, const Similarity3& start,
                                                   const RegistrationOptions& options);

/// A start without any hint.
struct CoarseStart {
  Rigid3 T_cloud_map;
  double score_m = 0;        ///< trimmed mean distance to a coarse cloud
  bool is_identity = false;  ///< the map's own frame taken as the cloud's
};
/// Up to six that end in different places, best first: the map's frame as the cloud's, and the map's walls laid onto the cloud's
/// in all ways at the places where most cells meet, each improved by closest points. The coarse scores of the best are close to
/// each other: register from each, and compare. kInvalid where there is too little to work with.
[[nodiscard]] Result<std::vector<CoarseStart>> find_coarse_starts(std::span<const Eigen::Vector3d> points_map,
                                                                  std::span<const Eigen::Vector3f> cloud_m,
                                                                  const Eigen::Vector3d& cloud_origin_m);

/// Mean over all points of the distance to the cloud, none counting more than `max_distance_m`: compares registrations.
[[nodiscard]] double capped_mean_distance(std::span<const Eigen::Vector3d> points_map, const CloudIndex& cloud, const Rigid3& T_cloud_map,
                                          double max_distance_m);

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
