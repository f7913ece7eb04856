// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapmaking/pose_consistency.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/base/mix_bits.h"
#include "core/base/order_statistics.h"

namespace camloc {
namespace {

constexpr double kMinInlierRatio = 0.3;

/// The points that a view measured, in its own camera: what another view is registered to.
class ViewPoints final : public LandmarkPositions {
 public:
  explicit ViewPoints(const FrameFeatures& view) : view_(&view) {}
  [[nodiscard]] Eigen::Vector3f position_m(std::int32_t i) const override {
    return view_->point_camera(static_cast<std::size_t>(i)).cast<float>();
  }

 private:
  const FrameFeatures* view_;
};

double median_normalized_square(const std::vector<double>& errors, const std::vector<double>& variances, double added_variance) {
  std::vector<double> values;
  for (std::size_t i = 0; i < errors.size(); ++i) values.push_back(errors[i] * errors[i] / std::max(variances[i] + added_variance, 1e-300));
  return upper_median(std::move(values));
}

}  // namespace

PoseSolverOptions pair_solver_options(const PoseConsistencyOptions& options) {
  PoseSolverOptions solver;
  solver.max_features = solver.max_candidates = solver.max_ransac_pairs = options.max_features;
  solver.candidate_ratio = 0.85;
  solver.min_inliers = options.min_inliers;
  solver.landmark_sigma_px = kFreshLandmarkSigmaPx;
  solver.gathers_evidence = false;
  return solver;
}

PoseEvidence register_views(const FrameFeatures& from, const FrameFeatures& to, std::uint64_t seed, PoseSolver* solver) {
  solver->candidates().clear();
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (from.depth_m[i] > 0)
      solver->candidates().add(from.features.descriptors[i], static_cast<std::int32_t>(i), from.features.keypoints[i].angle_rad);
  }
  solver->begin(to);
  return solver->solve(ViewPoints(from), solver->match_candidates(), seed);
}

double excess_sigma(const std::vector<double>& errors, const std::vector<double>& variances) {
  assert(errors.size() == variances.size());
  constexpr double kMedianChiSquared1 = 0.4549364;
  if (errors.empty() || median_normalized_square(errors, variances, 0) <= kMedianChiSquared1) return 0;
  double low = 0, high = 0;
  for (const double e : errors) high = std::max(high, 2.0 * std::abs(e));
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (median_normalized_square(errors, variances, middle * middle) > kMedianChiSquared1 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

PoseConsistency::PoseConsistency(const RgbdCamera& camera, const PyramidLevels& levels, const PoseConsistencyOptions& options)
    : camera_(camera), levels_(levels), options_(options) {}

// Keeps every stride-th view; when the store is full, every second of those goes and the stride doubles.
void PoseConsistency::add_view(const FrameFeatures& view) {
  if (num_added_++ % stride_ != 0) return;
  if (views_.size() >= options_.max_views) {
    for (std::size_t i = 0; 2 * i < views_.size(); ++i) views_[i] = std::move(views_[2 * i]);
    views_.resize((views_.size() + 1) / 2);
    stride_ *= 2;
    if ((num_added_ - 1) % stride_ != 0) return;
  }
  views_.push_back(view);
}

std::vector<PoseConsistency::Pair> PoseConsistency::candidate_pairs() const {
  const std::uint64_t gap = std::min<std::uint64_t>(options_.min_view_gap, num_added_ / 8 + 1);
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < views_.size(); ++i) {
    for (std::size_t j = i + 1; j < views_.size(); ++j) {
      const double distance = (views_[i].T_map_camera.translation - views_[j].T_map_camera.translation).norm();
      if ((j - i) * stride_ < gap || distance < options_.min_distance_m || distance > options_.max_distance_m) continue;
      const Eigen::Vector3d axis_i = views_[i].T_map_camera.rotation * Eigen::Vector3d::UnitZ();
      const Eigen::Vector3d axis_j = views_[j].T_map_camera.rotation * Eigen::Vector3d::UnitZ();
      if (axis_i.dot(axis_j) >= std::cos(options_.max_view_angle_rad)) pairs.push_back({mix_bits(i * views_.size() + j), i, j});
    }
  }
  std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.order < b.order; });
  return pairs;
}

PoseConsistencyEstimate PoseConsistency::estimate() const {
  PoseConsistencyEstimate result;
  PoseSolver solver(camera_, levels_, pair_solver_options(options_));
  std::vector<double> errors_m, variances_m2, errors_rad, variances_rad2;
  const std::vector<Pair> pairs = candidate_pairs();
  for (std::size_t k = 0; k < pairs.size() && k < options_.max_attempts && result.num_pairs < options_.max_pairs; ++k) {
    const FrameFeatures& from = views_[pairs[k].from];
    const FrameFeatures& to = views_[pairs[k].to];
    const PoseEvidence seen = register_views(from, to, k, &solver);
    if (!seen.is_found || seen.num_inliers < static_cast<std::uint32_t>(options_.min_inliers) || seen.inlier_ratio() < kMinInlierRatio)
      continue;
    const Vector6d error = pose_error(from.T_map_camera.inverse() * to.T_map_camera, seen.T_map_camera);
    for (int axis = 0; axis < 3; ++axis) {
      errors_m.push_back(error[axis]);
      variances_m2.push_back(seen.covariance(axis, axis));
      errors_rad.push_back(error[axis + 3]);
      variances_rad2.push_back(seen.covariance(axis + 3, axis + 3));
    }
    ++result.num_pairs;
  }
  result.sigma_m = excess_sigma(errors_m, variances_m2);
  result.sigma_rad = excess_sigma(errors_rad, variances_rad2);
  return result;
}

}  // namespace camloc
