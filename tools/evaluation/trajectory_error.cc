// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Errors are taken between the reference and the estimate after an optional rigid alignment; covariances turn with it, and NEES is
// taken in the axes of the reference.
#include "tools/evaluation/trajectory_error.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <numeric>

#include "core/geometry/alignment.h"
#include "core/geometry/symmetric_system.h"
#include "core/io/sequence.h"
#include "tools/common/text_format.h"

namespace camloc::tools {
namespace {

/// 95 % point of the chi-square distribution with 6 degrees of freedom.
constexpr double kChiSquare95 = 12.591587;

double quantile(std::vector<double>& values, double fraction) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const double position = fraction * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (position - static_cast<double>(below)) * (values[above] - values[below]);
}

}  // namespace

ErrorStatistics error_statistics(std::vector<double> values) {
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

Result<RecordedPoses> read_recorded_poses(const std::string& path, const std::string& frames, const std::optional<Rigid3>& T_color_depth) {
  if (!std::filesystem::is_directory(path)) {
    std::vector<std::string> notes;
    auto poses = read_tum_trajectory(path, &notes);
    if (!poses) return poses.status();
    const std::uint64_t count = poses->size();
    return RecordedPoses{std::move(poses).value(), count, std::move(notes)};
  }
  auto sequence = read_sequence(path);
  if (!sequence) return sequence.status();
  auto selected = select_frames(frames, "", sequence->frames.size());
  if (!selected) return selected.status();
  RecordedPoses recorded;
  auto poses = read_embedded_poses(*sequence, &recorded.notes);
  if (!poses) return poses.status();
  recorded.num_frames = selected->size();
  for (const std::size_t i : *selected) {
    if (!(*poses)[i]) continue;
    Rigid3 T_world_color = *(*poses)[i];
    if (T_color_depth) T_world_color = T_world_color * T_color_depth->inverse();
    recorded.poses.push_back({sequence->frames[i].stamp_ns, T_world_color});
  }
  return recorded;
}

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
  std::vector<double> translations, rotations, all_nees;
  for (const EstimatedPose& pose : estimate.poses) {
    const auto truth = reference(pose.stamp_ns);
    if (!truth) continue;
    ++errors.num_compared;
    const Rigid3 estimated = T * pose.T_map_camera;
    const double translation_m = (truth->translation - estimated.translation).norm();
    const double rotation_deg = degrees(rotation_distance_rad(truth->rotation, estimated.rotation));
    translations.push_back(translation_m);
    rotations.push_back(rotation_deg);
    for (std::size_t i = 0; i < kErrorLimits.size(); ++i) {
      if (translation_m <= kErrorLimits[i].translation_m && rotation_deg <= kErrorLimits[i].rotation_deg) errors.share_within[i] += 1;
    }
    if (is_misleading(*truth, estimated)) ++errors.num_misleading;
    if (!pose.covariance) continue;
    const Vector6d error = pose_error(*truth, estimated);
    all_nees.push_back(squared_mahalanobis(error, rotate_covariance(T.rotation, *pose.covariance)));
  }
  for (double& share : errors.share_within) share = num_frames == 0 ? 0.0 : share / static_cast<double>(num_frames);
  errors.translation_m = error_statistics(translations);
  errors.rotation_deg = error_statistics(rotations);
  errors.num_with_covariance = all_nees.size();
  if (!all_nees.empty()) {
    const auto inside = std::count_if(all_nees.begin(), all_nees.end(), [](double value) { return value <= kChiSquare95; });
    errors.share_inside_95 = static_cast<double>(inside) / static_cast<double>(all_nees.size());
    errors.nees_mean = error_statistics(all_nees).mean;
    errors.nees_median = error_statistics(all_nees).median;
  }
  return errors;
}

}  // namespace camloc::tools
