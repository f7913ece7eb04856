// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Truncated reprojection cost of one pose over many pairs: the inner loop of the robust estimator. Plain floats in
// structure of arrays, eight pairs at a time; every instruction set gives the same bits.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/geometry/correspondences.h"
#include "core/geometry/rigid3.h"

namespace camloc {

/// A pose as the kernel wants it: p_camera = R * p + t, row-major.
struct ScoredPose {
  float R[9];
  float t[3];
};

/// Pairs with their landmarks relative to `centre`, so that floats keep sub-millimetre precision far from the origin.
/// Allocates at construction only.
class PoseScorer {
 public:
  explicit PoseScorer(std::size_t max_pairs);

  /// Takes over the first `count` pairs. `max_relative_depth_error` 0 ignores measured depth.
  void set_pairs(const Correspondences& pairs, std::size_t count, double focal_px, double max_error_px, double max_relative_depth_error);

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] const Eigen::Vector3d& centre() const { return centre_; }
  /// Pair i: normalized image point, landmark relative to `centre`, measured depth (0 = none).
  [[nodiscard]] Eigen::Vector2d image_point(std::size_t i) const { return {x_[i], y_[i]}; }
  [[nodiscard]] Eigen::Vector3d landmark(std::size_t i) const { return {X_[i], Y_[i], Z_[i]}; }
  [[nodiscard]] bool has_depth(std::size_t i) const { return depth_[i] > 0.0F; }
  /// The distance between the points of pairs i and j, measured in the camera (both have depth), differs from that in the
  /// map by at most `relative` times the farther depth.
  [[nodiscard]] bool is_distance_consistent(std::size_t i, std::size_t j, float relative) const;

  /// Sum over all pairs of min(squared error, max_error^2), px^2, plus a constant that depends on the pairs alone; pairs
  /// behind the camera and pairs that contradict their measured depth count max_error^2. Returns something >= `limit` as
  /// soon as the sum reaches it: sums only grow, so the early exit never changes which pose wins.
  [[nodiscard]] float cost(const ScoredPose& pose, float limit) const;
  /// Squared error in px^2 where pair i is an inlier, max_error^2 where it is not; the arithmetic of `cost`.
  struct PairCost {
    bool is_inlier;
    float squared_error_px;
  };
  [[nodiscard]] PairCost pair_cost(const ScoredPose& pose, std::size_t i) const;

 private:
  std::size_t size_ = 0;
  Eigen::Vector3d centre_ = Eigen::Vector3d::Zero();
  float squared_focal_ = 1, max_squared_error_ = 1;
  std::vector<float> x_, y_, X_, Y_, Z_, depth_;
  std::vector<float> min_z_, max_z_;  // where the landmark's predicted depth must lie; an empty interval is padding
};

inline bool PoseScorer::is_distance_consistent(std::size_t i, std::size_t j, float relative) const {
  const float dx = x_[i] * depth_[i] - x_[j] * depth_[j], dy = y_[i] * depth_[i] - y_[j] * depth_[j], dz = depth_[i] - depth_[j];
  const float dX = X_[i] - X_[j], dY = Y_[i] - Y_[j], dZ = Z_[i] - Z_[j];
  const float in_camera = dx * dx + dy * dy + dz * dz, in_map = dX * dX + dY * dY + dZ * dZ;  // squared
  const float tolerance = relative * std::max(depth_[i], depth_[j]);
  // |a - b| <= t, with the squares of a and b, without roots: a^2 + b^2 - t^2 <= 2 a b.
  const float excess = in_camera + in_map - tolerance * tolerance;
  return (excess <= 0.0F) | (excess * excess <= 4.0F * in_camera * in_map);
}

inline PoseScorer::PairCost PoseScorer::pair_cost(const ScoredPose& pose, std::size_t i) const {
  const float px = pose.R[0] * X_[i] + pose.R[1] * Y_[i] + pose.R[2] * Z_[i] + pose.t[0];
  const float py = pose.R[3] * X_[i] + pose.R[4] * Y_[i] + pose.R[5] * Z_[i] + pose.t[1];
  const float pz = pose.R[6] * X_[i] + pose.R[7] * Y_[i] + pose.R[8] * Z_[i] + pose.t[2];
  const float inverse_z = 1.0F / pz;
  const float du = px * inverse_z - x_[i], dv = py * inverse_z - y_[i];
  const float squared = squared_focal_ * (du * du + dv * dv);
  const bool is_inlier = (squared < max_squared_error_) & (pz >= min_z_[i]) & (pz <= max_z_[i]);
  return {is_inlier, is_inlier ? squared : max_squared_error_};
}

}  // namespace camloc
