// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Pose from 2D-3D pairs with outliers, within a fixed amount of work: a fixed number of P3P samples, whatever the data.
// Samples are drawn progressively from the best-ranked pairs (Chum and Matas, "Matching with PROSAC", 2005), scored by
// the truncated squared error (Torr and Zisserman, "MLESAC", 2000) with an exact early exit, and the best are polished
// by local optimization (Chum, Matas, Kittler, "Locally optimized RANSAC", 2003).
#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/correspondences.h"
#include "core/geometry/pose_scorer.h"
#include "core/geometry/rigid3.h"

namespace camloc {

struct PnpRansacOptions {
  int iterations = 600;                    ///< P3P samples, always all of them: the work does not depend on the data
  double max_error_px = 5.0;               ///< inlier threshold
  double max_relative_depth_error = 0.15;  ///< a pair with measured depth is an outlier when |z - d| > this * d; 0 = off
  int local_optimizations = 12;            ///< at most this many improvements are polished
  int max_pairs = 1000;                    ///< buffers are sized for this many pairs
};

struct PnpRansacResult {
  bool is_found = false;
  Rigid3 T_map_camera;
  int num_inliers = 0;
  double cost = 0;  ///< sum of truncated squared errors, px^2, over all pairs
};

/// Not thread-safe; allocates at construction only.
class PnpRansac {
 public:
  explicit PnpRansac(const PnpRansacOptions& options);

  /// `pairs` must be ordered by rank, best first. `focal_px` turns normalized errors into pixels. The same pairs and
  /// the same seed give the same bits. Fewer than 4 pairs give is_found = false. Of more than `max_pairs` pairs the best
  /// `max_pairs` are used.
  ///
  /// Sample k of K is drawn from the best n(k) pairs, the smallest n with C(n,3) / C(N,3) >= k / K: PROSAC's growth, which
  /// reaches all N pairs at the last sample (k = 1 % of K draws from 22 % of the pairs, 12 % from half). Where all three
  /// pairs of a sample carry depth, their distances in the camera must fit those in the map within
  /// max_relative_depth_error of the farther depth; a sample that does not fit is drawn again, at most 8 times.
  [[nodiscard]] PnpRansacResult estimate(const Correspondences& pairs, double focal_px, std::uint64_t seed);

  /// 1 per pair that is an inlier of the last result, in the order of the pairs (the best `max_pairs` of them).
  [[nodiscard]] const std::vector<std::uint8_t>& inlier_mask() const { return inlier_mask_; }

 private:
  PnpRansacOptions options_;
  PoseScorer scorer_;
  std::vector<std::uint8_t> inlier_mask_;
};

}  // namespace camloc
