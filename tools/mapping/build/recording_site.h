// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Where a recording lies in the world: which way is up, and, where control points were surveyed, the site's coordinates.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/geometry/gravity.h"
#include "core/geometry/wcs.h"
#include "core/slam/slam.h"
#include "tools/mapping/build/recording_tracking.h"
#include "tools/mapping/site/control_points.h"
#include "tools/mapping/site/georef_fit.h"

namespace camloc::mapping {

/// Up in the frame of the largest segment: from accelerometer readings where the file is named or lies in the recording's
/// folder (accelerometer.txt), else from the floor. kNotFound where neither says. An accelerometer file that cannot be read is
/// another error.
[[nodiscard]] Result<GravityEstimate> find_up(const SlamResult& result, const std::vector<KeyframeSurface>& surfaces,
                                              const std::string& folder, const std::string& accelerometer_path);

/// Turns all poses of a segment so that up becomes z.
void level(const Eigen::Vector3d& up_map, std::uint32_t segment, SlamResult* result);

/// Control points as a build takes them: names, site coordinates, pixels of frames.
struct SurveyRequest {
  std::string points_path, observed_path;  ///< both or none
  bool is_excluding_suspects = false;
};

struct Survey {
  std::vector<ControlPoint> points;
  std::vector<ControlObservation> observations;  ///< all of them pixels
  PixelMeasurements measurements;
};

/// Reads both files and measures the pixels in the frames they name. kInvalid for observations that are no pixels.
[[nodiscard]] Result<Survey> read_survey(const SurveyRequest& request, const std::string& folder, const RgbdCamera& camera,
                                         double pair_ms = 20);
/// Frames that must become keyframes, ascending.
[[nodiscard]] std::vector<std::uint64_t> frames_of(const Survey& survey);

/// Fits site and map, adjusts the map held by the points, fits again. The datum is empty when the fit has a problem, which
/// `summary` then names; `result` is left as it was.
[[nodiscard]] std::optional<WcsDatum> adjust_to_survey(const SurveyRequest& request, const Survey& survey, const RgbdCamera& camera,
                                                       Slam* slam, SlamResult* result, GeorefSummary* summary);

}  // namespace camloc::mapping
