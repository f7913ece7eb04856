// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The rigid motion or similarity between two sets of corresponding points with the least sum of squared residuals (Umeyama,
// "Least-squares estimation of transformation parameters between two point patterns", 1991), how well the points determine
// it, and what it predicts for each point from the others. No robustness: a wrong pair pulls.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/rigid3.h"

namespace camloc {

/// One point in two frames. Coordinates may be as large as those of a national grid: only differences are squared.
struct PointPair {
  Eigen::Vector3d p_a = Eigen::Vector3d::Zero(), p_b = Eigen::Vector3d::Zero();
  double sigma_m = 1;  ///< of p_a - T_a_b * p_b, per axis, > 0; equal ones give the unweighted fit
};

/// What the points determine.
enum class AlignmentRank : std::uint8_t {
  kNothing,   ///< no point
  kPosition,  ///< all points are in one place: no direction is known
  kLine,      ///< all on a line: the turn about it is not known
  kFull,
};

struct Alignment {
  Rigid3 T_a_b;            ///< p_a = scale * R_a_b * p_b + t; what the points leave open is turned as little as possible
  double scale = 1;        ///< 1 in a rigid alignment
  double scale_sigma = 0;  ///< standard deviation that `scale` has, or would have, when it is free
  AlignmentRank rank = AlignmentRank::kNothing;
  Eigen::Vector3d free_axis = Eigen::Vector3d::Zero();  ///< kLine: unit vector along the line, axes of `a`
  /// Of pose_error() of T_a_b for a rigid alignment, from the sigmas alone; a turn that is not determined has a standard
  /// deviation of pi. In kNothing the position is as unknown: 1e6 m.
  Matrix6d covariance = Matrix6d::Zero();
  double rms_m = 0;            ///< of the residuals' lengths
  double chi_squared = 0;      ///< sum of the squared residuals over sigma
  int degrees_of_freedom = 0;  ///< 3 a point less the parameters that the points determine; at least 0

  [[nodiscard]] Eigen::Vector3d map(const Eigen::Vector3d& p_b) const { return scale * (T_a_b.rotation * p_b) + T_a_b.translation; }
};

/// A pose in both frames as points: its centre, and with a lever > 0 a point that far along each axis, so that orientations
/// count like positions at that distance.
void add_pose_points(const Rigid3& T_a_camera, const Rigid3& T_b_camera, double lever_m, std::vector<PointPair>* pairs);

[[nodiscard]] Alignment align_rigid(std::span<const PointPair> pairs);
/// Also frees the scale. Points that are in one place keep scale 1.
[[nodiscard]] Alignment align_similarity(std::span<const PointPair> pairs);

/// How far a point is from where the others put it.
struct LeaveOneOutResidual {
  Eigen::Vector3d error_m = Eigen::Vector3d::Zero();  ///< p_a - prediction
  /// Expected covariance of that error: of the prediction and of the point itself.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
  bool is_determined = false;  ///< false: the others do not determine a rigid motion; both values above mean nothing
  /// Length of the error in its own standard deviations; 3 degrees of freedom, so that 99 % are below 3.4.
  [[nodiscard]] double sigmas() const;
};

/// One per pair, from the rigid alignment of all the others.
[[nodiscard]] std::vector<LeaveOneOutResidual> leave_one_out(std::span<const PointPair> pairs);

/// The same for a point that took no part in `alignment`.
[[nodiscard]] LeaveOneOutResidual predicted_residual(const Alignment& alignment, const PointPair& pair);

}  // namespace camloc
