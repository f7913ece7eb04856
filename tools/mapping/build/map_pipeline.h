// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// From a recording to a map file: what `camloc map build` does once its arguments are understood. Read build_map first.
#pragma once

#include <string>

#include "core/base/result.h"
#include "core/geometry/camera.h"
#include "core/mapmaking/map_builder.h"
#include "core/slam/slam.h"
#include "tools/mapping/build/build_report.h"
#include "tools/mapping/build/posed_frames.h"
#include "tools/mapping/build/recording_site.h"

namespace camloc::mapping {

struct BuildRequest {
  PosedFramesRequest frames;  ///< `poses` empty: SLAM finds them
  RgbdCamera camera;
  MapBuildOptions map;
  SlamOptions slam;
  std::string map_path;
  std::string extend_path;      ///< map that the recording is merged into, see merge_pipeline.h; empty: a map of its own
  std::string name;             ///< of the map; empty: the folder's
  std::string trajectory_path;  ///< where the camera was, TUM format; empty: not written
  bool is_resumed = false;
  bool is_levelled = true;         ///< turn the map so that z is up where floor or accelerometer show which way that is
  std::string accelerometer_path;  ///< empty: accelerometer.txt of the recording, if there is one and no floor
  SurveyRequest survey;            ///< control points
};

/// Makes the map and says what came of it. Errors: kInvalid for what the user can change in the request or the recording. An
/// existing map at the path is replaced by a complete one or stays as it is.
[[nodiscard]] Status build_map(const BuildRequest& request, WorkObserver& observer, BuildSummary* summary);

/// The view log of a build, beside its map.
[[nodiscard]] std::string frame_log_path(const std::string& map_path);

}  // namespace camloc::mapping
