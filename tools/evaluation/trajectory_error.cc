// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Errors are taken between the reference and the estimate after an optional rigid alignment; covariances turn with it, and NEES is
// taken in the axes of the reference.
#include "tools/evaluation/trajectory_error.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/geometry/alignment.h"

namespace camloc::tools {
namespace {

/// 95 % point of the chi-square distribution with 6 degrees of freedom.
constexpr double kChiSquare95 = 12.591587;

struct Pair {
  Rigid3 reference, estimate;
  std::optional<Matrix6d> covariance;
};

double quantile(std::vector<double>& values, double fraction) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const double position = fraction * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (position - static_cast<double>(below)) * (values[above] - values[below]);
}

ErrorStatistics statistics(std::vector<double> values) {
  if (values.empty()) return {};
  ErrorStatistics out;
  out.mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  for (const double value : values) out.rmse += value * value / static_cast<double>(values.size());
  out.rmse = std::sqrt(out.rmse);
  out.median = quantile(values, 0.5);
  out.p90 = quantile(values, 0.9);
  out.max = values.back();
  return out;
}

double nees(const Pair& pair) {
  const Vector6d error = pose_error(pair.reference, pair.estimate);
  return error.dot(pair.covariance->ldlt().solve(error));
}

}  // namespace

Rigid3 align_by_positions(const EstimatedTrajectory& estimate, const ReferencePose& reference) {
  std::vector<PointPair> points;
  for (const EstimatedPose& pose : estimate.poses) {
    if (const auto truth = reference(pose.stamp_ns)) points.push_back({truth->translation, pose.T_map_camera.translation});
  }
  return points.size() < 3 ? Rigid3{} : align_rigid(points).T_a_b;
}

Rigid3 align_by_poses(const EstimatedTrajectory& estimate, const ReferencePose& reference) {
  constexpr double kLeverM = 1.0;
  std::vector<PointPair> points;
  for (const EstimatedPose& pose : estimate.poses) {
    if (const auto truth = reference(pose.stamp_ns)) add_pose_points(*truth, pose.T_map_camera, kLeverM, &points);
  }
  return points.empty() ? Rigid3{} : align_rigid(points).T_a_b;
}

bool is_misleading(const Rigid3& reference, const Rigid3& estimate) {
  return (reference.translation - estimate.translation).norm() > kMisleading.translation_m ||
         rotation_distance_rad(reference.rotation, estimate.rotation) * 180.0 / std::numbers::pi > kMisleading.rotation_deg;
}

TrajectoryErrors compare(const EstimatedTrajectory& estimate, const ReferencePose& reference, std::uint64_t num_frames,
                         const std::optional<Rigid3>& T_reference_estimate) {
  TrajectoryErrors errors;
  errors.num_frames = num_frames;
  errors.num_localized = estimate.poses.size();
  errors.T_reference_estimate = T_reference_estimate;
  const Rigid3 T = T_reference_estimate.value_or(Rigid3{});
  std::vector<Pair> pairs;
  for (const EstimatedPose& pose : estimate.poses) {
    const auto truth = reference(pose.stamp_ns);
    if (!truth) continue;
    Pair& pair = pairs.emplace_back(Pair{*truth, T * pose.T_map_camera, pose.covariance});
    if (pair.covariance) pair.covariance = rotate_covariance(T.rotation, *pair.covariance);
  }
  errors.num_compared = pairs.size();

  std::vector<double> translations, rotations, all_nees;
  for (const Pair& pair : pairs) {
    const double translation_m = (pair.reference.translation - pair.estimate.translation).norm();
    const double rotation_deg = rotation_distance_rad(pair.reference.rotation, pair.estimate.rotation) * 180.0 / std::numbers::pi;
    translations.push_back(translation_m);
    rotations.push_back(rotation_deg);
    for (std::size_t i = 0; i < kErrorLimits.size(); ++i) {
      if (translation_m <= kErrorLimits[i].translation_m && rotation_deg <= kErrorLimits[i].rotation_deg) errors.share_within[i] += 1;
    }
    if (is_misleading(pair.reference, pair.estimate)) ++errors.num_misleading;
    if (pair.covariance) all_nees.push_back(nees(pair));
  }
  for (double& share : errors.share_within) share = num_frames == 0 ? 0.0 : share / static_cast<double>(num_frames);
  errors.translation_m = statistics(translations);
  errors.rotation_deg = statistics(rotations);
  errors.num_with_covariance = all_nees.size();
  if (!all_nees.empty()) {
    const auto inside = std::count_if(all_nees.begin(), all_nees.end(), [](double value) { return value <= kChiSquare95; });
    errors.share_inside_95 = static_cast<double>(inside) / static_cast<double>(all_nees.size());
    errors.nees_mean = statistics(all_nees).mean;
    errors.nees_median = statistics(all_nees).median;
  }
  return errors;
}

}  // namespace camloc::tools
