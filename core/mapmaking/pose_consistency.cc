// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapmaking/pose_consistency.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/base/mix_bits.h"
#include "core/base/order_statistics.h"
#include "core/features/matcher.h"
#include "core/geometry/correspondences.h"
#include "core/geometry/pnp_ransac.h"
#include "core/geometry/pose_refinement.h"

namespace camloc {
namespace {

constexpr double kMinInlierRatio = 0.3;

/// Registers one view to another: the depth points of `from` are the map, the pixels of `to` are the query.
class Registration {
 public:
  Registration(const RgbdCamera& camera, const PoseConsistencyOptions& options)
      : focal_px_(camera.color.mean_focal_px()),
        min_inliers_(options.min_inliers),
        capacity_(static_cast<std::size_t>(options.max_features)),
        candidates_(capacity_),
        matcher_(CandidateMatcherOptions{.max_distance = 64, .max_ratio = 0.85}, options.max_features, capacity_),
        pairs_(capacity_),
        ransac_(PnpRansacOptions{.max_error_px = 4.0, .max_pairs = options.max_features}) {
    refinement_.depth_noise = camera.depth_noise;
  }

  /// T_from_to and its covariance; false when the views do not register.
  bool run(const ViewFeatures& from, const ViewFeatures& to, std::uint64_t seed, PoseRefinementResult* result) {
    candidates_.clear();
    for (std::size_t i = 0; i < from.features.size(); ++i) {
      if (from.depth_m[i] > 0)
        candidates_.add(from.features.descriptors[i], static_cast<std::int32_t>(i), from.features.keypoints[i].angle_rad);
    }
    pairs_.clear();
    for (const Match& match : matcher_.match(to.features, candidates_)) add_pair(from, to, match);
    pairs_.sort_by_rank();
    const PnpRansacResult found = ransac_.estimate(pairs_, focal_px_, seed);
    if (!found.is_found || found.num_inliers < min_inliers_) return false;
    *result = refine_pose(pairs_, found.T_map_camera, focal_px_, refinement_, nullptr);
    return result->is_converged && result->num_inliers >= min_inliers_ &&
           result->num_inliers >= kMinInlierRatio * static_cast<double>(pairs_.size());
  }

 private:
  void add_pair(const ViewFeatures& from, const ViewFeatures& to, const Match& match) {
    const auto f = static_cast<std::size_t>(match.feature), l = static_cast<std::size_t>(match.landmark);
    const float z = from.depth_m[l];
    const float sigma_px = std::pow(1.2F, static_cast<float>(to.features.keypoints[f].level));
    pairs_.add(to.normalized[f].x(), to.normalized[f].y(), z * from.normalized[l].x(), z * from.normalized[l].y(), z, to.depth_m[f],
               sigma_px, match.distance, match.feature, match.landmark);
  }

  double focal_px_;
  int min_inliers_;
  std::size_t capacity_;
  CandidateSet candidates_;
  CandidateMatcher matcher_;
  Correspondences pairs_;
  PnpRansac ransac_;
  PoseRefinementOptions refinement_;
};

double median_normalized_square(const std::vector<double>& errors, const std::vector<double>& variances, double added_variance) {
  std::vector<double> values;
  for (std::size_t i = 0; i < errors.size(); ++i) values.push_back(errors[i] * errors[i] / std::max(variances[i] + added_variance, 1e-300));
  return upper_median(std::move(values));
}

}  // namespace

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

PoseConsistency::PoseConsistency(const RgbdCamera& camera, const PoseConsistencyOptions& options) : camera_(camera), options_(options) {}

// Keeps every stride-th view; when the store is full, every second of those goes and the stride doubles.
void PoseConsistency::add_view(const ViewFeatures& view) {
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
  Registration registration(camera_, options_);
  std::vector<double> errors_m, variances_m2, errors_rad, variances_rad2;
  const std::vector<Pair> pairs = candidate_pairs();
  for (std::size_t k = 0; k < pairs.size() && k < options_.max_attempts && result.num_pairs < options_.max_pairs; ++k) {
    const ViewFeatures& from = views_[pairs[k].from];
    const ViewFeatures& to = views_[pairs[k].to];
    PoseRefinementResult seen;
    if (!registration.run(from, to, k, &seen)) continue;
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
