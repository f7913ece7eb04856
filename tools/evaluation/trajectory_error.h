// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Poses to compare with, and how far a trajectory is from them: error statistics, shares within the usual limits of all frames, misleading
// poses, and whether the covariances were honest.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "core/geometry/camera.h"
#include "core/io/sequence.h"
#include "tools/common/trajectory_file.h"

namespace camloc::tools {

struct RecordedPoses {
  std::vector<StampedPose> poses;  ///< T_world_camera of the colour camera, of the selected frames that have one
  std::uint64_t num_frames = 0;    ///< selected ones, with and without a pose
  std::vector<std::string> notes;  ///< what was left out, for people: a line each
};

/// RgbdCamera::T_color_depth where recorded poses belong to the depth camera.
[[nodiscard]] inline std::optional<Rigid3> depth_camera_offset(const RgbdCamera& camera) {
  return camera.poses_are_of_depth_camera ? std::optional(camera.T_color_depth) : std::nullopt;
}

/// `path`: folder of a recording, else a trajectory in TUM format, of which all is taken. `frames` is a selection in the notation of
/// --frames, empty for all. `T_color_depth` is set where the recorded poses belong to the depth camera.
[[nodiscard]] Result<RecordedPoses> read_recorded_poses(const std::string& path, const std::string& frames,
                                                        const std::optional<Rigid3>& T_color_depth);

struct ErrorStatistics {
  double median = 0, mean = 0, rmse = 0, p90 = 0, max = 0;
};

/// Zeros without values.
[[nodiscard]] ErrorStatistics error_statistics(std::vector<double> values);

/// "Within 5cm/5deg" and so on; the share is of all frames.
struct ErrorLimit {
  const char* name;
  double translation_m, rotation_deg;
};
inline constexpr std::array<ErrorLimit, 4> kErrorLimits{
    {{"2cm_2deg", 0.02, 2}, {"5cm_5deg", 0.05, 5}, {"10cm_10deg", 0.10, 10}, {"35cm_10deg", 0.35, 10}}};
/// A pose given as LOCALIZED and farther off than this misleads.
inline constexpr ErrorLimit kMisleading{"misleading", 0.25, 10};
[[nodiscard]] bool is_misleading(const Rigid3& reference, const Rigid3& estimate);

struct TrajectoryErrors {
  std::uint64_t num_frames = 0;     ///< all frames that were tried
  std::uint64_t num_localized = 0;  ///< poses in the estimate
  std::uint64_t num_compared = 0;   ///< of those with a reference pose
  ErrorStatistics translation_m, rotation_deg;
  std::array<double, kErrorLimits.size()> share_within{};
  std::uint64_t num_misleading = 0;
  std::uint64_t num_with_covariance = 0;
  double nees_mean = 0, nees_median = 0;       ///< 6 degrees of freedom: 6 and 5.35 when honest
  double share_inside_95 = 0;                  ///< NEES below 12.59
  std::optional<Rigid3> T_reference_estimate;  ///< of the alignment, when there was one
};

using ReferencePose = std::function<std::optional<Rigid3>(std::int64_t stamp_ns)>;

/// The rigid motion that brings the positions of the estimate closest to those of the reference (Umeyama, "Least-squares
/// estimation of transformation parameters between two point patterns", 1991; scale 1): what the absolute trajectory error is
/// taken after. Identity with fewer than three common poses.
[[nodiscard]] Rigid3 align_by_positions(const EstimatedTrajectory& estimate, const ReferencePose& reference);
/// The same with orientations, which count like positions on a lever of one metre: for bringing one trajectory into a frame by
/// means of another, where a short recording leaves the turn open. Identity without a common pose.
[[nodiscard]] Rigid3 align_by_poses(const EstimatedTrajectory& estimate, const ReferencePose& reference);

/// `T_reference_estimate` is applied to the estimate first.
[[nodiscard]] TrajectoryErrors compare(const EstimatedTrajectory& estimate, const ReferencePose& reference, std::uint64_t num_frames,
                                       const std::optional<Rigid3>& T_reference_estimate = std::nullopt);

}  // namespace camloc::tools
