// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// From a recording to a map file: what `camloc map build` does once its arguments are understood. Read build_map first.
// What came of it is a BuildSummary, as a table or JSON (build_report.cc).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/geometry/camera.h"
#include "core/geometry/gravity.h"
#include "core/map/map_data.h"
#include "core/mapmaking/map_builder.h"
#include "core/slam/slam.h"
#include "tools/common/frame_reading.h"
#include "tools/mapping/build/merge_pipeline.h"
#include "tools/mapping/build/pose_check.h"
#include "tools/mapping/build/posed_frames.h"
#include "tools/mapping/build/recording_site.h"
#include "tools/mapping/build/recording_tracking.h"
#include "tools/mapping/colmap/colmap_model.h"
#include "tools/mapping/site/georef_fit.h"

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
  bool believes_poses = false;  ///< make a map of given poses that the images contradict
  bool is_resumed = false;
  bool is_levelled = true;         ///< turn the map so that z is up where floor or accelerometer show which way that is
  std::string accelerometer_path;  ///< empty: accelerometer.txt of the recording, if there is one and no floor
  SurveyRequest survey;            ///< control points
};

/// What SLAM says about a recording without poses.
struct SlamSummary {
  SlamCounts counts;
  MapFit fit;  ///< of the largest segment
  std::vector<WeakSpot> weak_spots;
  std::uint64_t num_stamp_jumps = 0;
  std::uint64_t num_resumed = 0;      ///< frames taken from an interrupted build
  std::string up_problem;             ///< why no vertical was found
  std::optional<GravityEstimate> up;  ///< before the map was turned
};

/// A stretch of the recording that hangs together with nothing else.
struct SubmapSummary {
  std::string map_path;  ///< empty: too short for a map
  std::uint32_t num_keyframes = 0, num_views = 0;
};

struct BuildSummary {
  std::string map_path, sequence, camera;
  std::uint64_t num_recorded = 0, num_selected = 0, num_without_pose = 0, num_without_depth = 0;
  std::vector<std::string> notes;  ///< what was left out of recording and poses: a line each
  tools::FrameCounts reading;      ///< broken frames, and what was wrong with the first of them
  bool is_partial = false;         ///< interrupted: a map of the first part
  std::optional<SlamSummary> slam;
  std::optional<PoseVerdict> pose_verdict;  ///< of given poses: what the images say
  std::optional<ModelScale> model_scale;    ///< of the COLMAP model that the poses are from
  std::optional<GeorefSummary> survey;      ///< control points, where there were some
  std::vector<SubmapSummary> submaps;       ///< besides the map itself
  MapBuildReport build;
  std::optional<MergeSummary> merge;                          ///< with the map that was extended; `build` then counts the recording alone
  double consistency_sigma_m = 0, consistency_sigma_rad = 0;  ///< of the poses between views, per axis
  MapUncertainty deformation;                                 ///< of a map without given poses
  double seconds = 0;
};

[[nodiscard]] std::string format_table(const BuildSummary& summary);
[[nodiscard]] std::string format_json(const BuildSummary& summary);

/// Makes the map and says what came of it. Errors: kInvalid for what the user can change in the request or the recording. An
/// existing map at the path is replaced by a complete one or stays as it is.
[[nodiscard]] Status build_map(const BuildRequest& request, WorkObserver& observer, BuildSummary* summary);

/// The frame log of a build, beside its map.
[[nodiscard]] std::string frame_log_path(const std::string& map_path);

}  // namespace camloc::mapping
