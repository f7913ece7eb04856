// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The trajectory that `camloc localize` writes and `camloc eval` reads: a TUM file that every TUM reader takes, with what
// TUM has no field for in comments:
//   # frames N                                  all frames that were tried, localized or not
//   # reference_camera depth tx ty tz qx qy qz qw   recorded poses belong to the depth camera; its T_color_depth
//   # calibration suspect focal_scale S             the images fit the map only with another focal length
//   # covariance c11 c12 ... c66                21 values, upper triangle, of the pose on the next line
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"

namespace camloc::tools {

struct EstimatedPose {
  std::int64_t stamp_ns = 0;
  Rigid3 T_map_camera;
  std::optional<Matrix6d> covariance;  ///< of pose_error()
};

struct EstimatedTrajectory {
  std::vector<EstimatedPose> poses;           ///< LOCALIZED frames only
  std::optional<std::uint64_t> num_frames;    ///< all frames that were tried
  std::optional<Rigid3> T_color_depth;        ///< set where recorded poses belong to the depth camera
  std::optional<double> suspect_focal_scale;  ///< true / assumed focal length, where they differ
};

[[nodiscard]] std::string format_trajectory(const EstimatedTrajectory& trajectory);
/// Reads both our own files and plain TUM files. Errors name file and line.
[[nodiscard]] Result<EstimatedTrajectory> read_trajectory(const std::string& path);

}  // namespace camloc::tools
