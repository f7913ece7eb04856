// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Lays the points of a map onto a cloud: by trimmed iterative closest points, and without any hint.
// `map` is the frame of the landmarks, `cloud` that of a PointCloud relative to its origin.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/result.h"
#include "core/geometry/rigid3.h"
#include "tools/camloc-map/cloud_index.h"

namespace camloc::map_tool {

/// p_a = scale * rigid.rotation * p_b + rigid.translation.
struct Similarity3 {
  double scale = 1;
  Rigid3 rigid;
  [[nodiscard]] Eigen::Vector3d operator*(const Eigen::Vector3d& p) const { return scale * (rigid.rotation * p) + rigid.translation; }
};

struct RegistrationOptions {
  double trim = 0.9;             ///< share of the correspondences that is used, the closest
  double max_distance_m = 0.5;   ///< a neighbour farther away is no correspondence
  double start_distance_m = 0.5; ///< the same at the beginning; shrinks to max_distance_m
  int max_iterations = 60;
  std::size_t max_points = 20000;  ///< evenly chosen from the landmarks
  bool has_scale = false;        ///< a seventh degree of freedom, for checking only
};

struct Registration {
  Similarity3 T_cloud_map;
  int num_iterations = 0;
  std::uint64_t num_points = 0, num_correspondences = 0;   ///< tried, and used in the last iteration
  double rms_m = 0;                    ///< of the distances to the surface in the last iteration, with the weights of the robust kernel
  bool is_converged = false;
  double sigma_scale = 0;              ///< with has_scale: standard deviation, correspondences taken as independent
  /// Share of the correspondences whose surface stands across the direction in which the cloud holds the map least (0: it
  /// can slide along there freely; 1/3: equally in all directions), and that direction in the cloud's axes.
  double weakest_share = 0;
  Eigen::Vector3d weakest_direction = Eigen::Vector3d::Zero();
};

/// Iterative closest points, point to plane (Chen and Medioni, "Object modelling by registration of multiple range images", 1992),
/// trimmed (Chetverikov, Svirko, Stepanov, Krsek, "The trimmed iterative closest point algorithm", 2002), with Cauchy weights whose
/// width follows the residuals, solved by Gauss-Newton with a little damping; at the end some iterations without trimming.
/// kInvalid: fewer than ten correspondences within the distance.
[[nodiscard]] Result<Registration> register_points(std::span<const Eigen::Vector3d> points_map, CloudIndex* cloud, const Similarity3& start,
                                                   const RegistrationOptions& options);

/// A start without any hint: the map's frame taken as the cloud's, and principal axes laid onto each other in all ways, each
/// improved on a coarse cloud. Choose by `score_m`, the trimmed mean distance; `rival_score_m` is that of the best start that
/// ends elsewhere: close to score_m means that the building looks alike from there.
struct CoarseStart {
  Rigid3 T_cloud_map;
  double score_m = 0, rival_score_m = 0;
  bool is_identity = false;     ///< the map's own frame was the best start
};
[[nodiscard]] Result<CoarseStart> find_coarse_start(std::span<const Eigen::Vector3d> points_map, std::span<const Eigen::Vector3f> cloud_m,
                                                    const Eigen::Vector3d& cloud_origin_m);

}  // namespace camloc::map_tool
