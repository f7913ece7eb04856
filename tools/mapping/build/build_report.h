// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What a map build says: a table or JSON when it is done.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/gravity.h"
#include "core/map/map_data.h"
#include "core/mapmaking/map_builder.h"
#include "core/slam/slam.h"
#include "tools/common/frame_reading.h"
#include "tools/mapping/build/merge_pipeline.h"
#include "tools/mapping/build/recording_tracking.h"
#include "tools/mapping/colmap/colmap_model.h"
#include "tools/mapping/site/georef_fit.h"

namespace camloc::mapping {

/// What SLAM says about a walk without poses.
struct SlamSummary {
  SlamCounts counts;
  MapFit fit;  ///< of the largest segment
  std::vector<WeakSpot> weak_spots;
  std::uint64_t num_stamp_jumps = 0;
  std::uint64_t num_resumed = 0;      ///< views taken from an interrupted build
  std::string up_problem;             ///< why no vertical was found
  std::optional<GravityEstimate> up;  ///< before the map was turned
};

/// A stretch of the walk that hangs together with nothing else.
struct SubmapSummary {
  std::string map_path;  ///< empty: too short for a map
  std::uint32_t num_keyframes = 0, num_views = 0;
};

struct BuildSummary {
  std::string map_path, sequence, camera;
  std::uint64_t num_recorded = 0, num_selected = 0, num_without_pose = 0, num_without_depth = 0;
  tools::FrameCounts reading;  ///< broken frames, and what was wrong with the first of them
  bool is_partial = false;     ///< interrupted: a map of the first part
  std::optional<SlamSummary> slam;
  std::optional<ModelScale> model_scale;  ///< of the COLMAP model that the poses are from
  std::optional<GeorefSummary> survey;    ///< control points, where there were some
  std::vector<SubmapSummary> submaps;     ///< besides the map itself
  MapBuildReport build;
  std::optional<MergeSummary> merge;                          ///< with the map that was extended; `build` then counts the recording alone
  double consistency_sigma_m = 0, consistency_sigma_rad = 0;  ///< of the poses between views, per axis
  MapUncertainty deformation;                                 ///< of a map without given poses
  double seconds = 0;
};

[[nodiscard]] std::string format_table(const BuildSummary& summary);
[[nodiscard]] std::string format_json(const BuildSummary& summary);

}  // namespace camloc::mapping
