// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// How far the poses a map is made from disagree with what its images say. Pairs of views that are near in space but not in
// time are registered from their features alone; the recorded relative pose differs from that by more than the
// registration's own covariance explains. No pose found in the map can be better than this.
#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/camera.h"
#include "core/mapmaking/landmark_fusion.h"
#include "core/registration/keypoint_noise.h"
#include "core/registration/pose_solver.h"

namespace camloc {

struct PoseConsistencyOptions {
  double min_distance_m = 0.10, max_distance_m = 0.70;  ///< between the camera centres of a pair
  double max_view_angle_rad = 0.7;                      ///< between their optical axes
  std::uint32_t min_view_gap = 30;                      ///< views between them, in the order they were added; less in short maps
  std::uint32_t max_pairs = 80;
  std::uint32_t max_attempts = 240;
  std::uint32_t max_views = 256;  ///< kept in memory, evenly spread over the sequence
  int min_inliers = 40;
  int max_features = 2000;
};

struct PoseConsistencyEstimate {
  double sigma_m = 0, sigma_rad = 0;  ///< one standard deviation per axis; 0 when there is no pair to tell from
  std::uint32_t num_pairs = 0;
};

/// Not thread-safe. The same views in the same order give the same bits.
class PoseConsistency {
 public:
  PoseConsistency(const RgbdCamera& camera, const PyramidLevels& levels, const PoseConsistencyOptions& options);
  void add_view(const FrameFeatures& view);
  [[nodiscard]] PoseConsistencyEstimate estimate() const;

 private:
  struct Pair {
    std::uint64_t order;
    std::size_t from, to;
  };
  [[nodiscard]] std::vector<Pair> candidate_pairs() const;

  RgbdCamera camera_;
  PyramidLevels levels_;
  PoseConsistencyOptions options_;
  std::uint64_t num_added_ = 0, stride_ = 1;
  std::vector<FrameFeatures> views_;
};

/// T_from_to and its covariance, from the depth points of one and the pixels of the other; nobody's pose is looked at.
[[nodiscard]] PoseEvidence register_views(const FrameFeatures& from, const FrameFeatures& to, std::uint64_t seed, PoseSolver* solver);
/// Of a solver for register_views().
[[nodiscard]] PoseSolverOptions pair_solver_options(const PoseConsistencyOptions& options);

/// The standard deviation that, added to each error's own variance, makes the squared normalized errors have the median
/// of a chi-squared variable with one degree of freedom; 0 when their own variances explain them already. Robust: half of
/// the errors may be anything. Both vectors have the same length.
[[nodiscard]] double excess_sigma(const std::vector<double>& errors, const std::vector<double>& variances);

}  // namespace camloc
