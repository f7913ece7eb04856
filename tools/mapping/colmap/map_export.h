// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A map in the formats that other people's viewers read: point cloud (PLY), COLMAP model, TUM trajectory.
#pragma once

#include <string>

#include "core/base/result.h"
#include "core/map/map_view.h"
#include "tools/mapping/colmap/colmap_model.h"

namespace camloc::mapping {

enum class PointColoring { kHeight, kObservations };

struct ExportOptions {
  bool use_wcs = false;  ///< coordinates of the site in place of those of the map; needs a datum
  PointColoring coloring = PointColoring::kHeight;
};

/// kInvalid where site coordinates are asked of a map without a datum; nothing else below can fail.
[[nodiscard]] Status check_export(const MapView& map, const ExportOptions& options);

/// PLY 1.0, binary little endian, one vertex a landmark: x y z (metres; doubles in site coordinates), nx ny nz (mean direction
/// towards the cameras), red green blue, num_observations (at most 255), position_sigma_m.
[[nodiscard]] std::string format_ply(const MapView& map, const ExportOptions& options);

/// Keyframes as images `keyframe-NNNNNN`, landmarks as points. A map keeps no keypoints, so an observation is where a landmark
/// of the keyframe's list projects to; those outside the image are left out.
[[nodiscard]] ColmapModel make_colmap_model(const MapView& map, const ExportOptions& options);

/// TUM trajectory of the keyframes. A map keeps no stamps, so the time of keyframe N is N seconds.
[[nodiscard]] std::string format_tum(const MapView& map, const ExportOptions& options);

/// "map NAME (0123456789abcdef), metres, ...": what a file that was exported says about its origin; one line.
[[nodiscard]] std::string describe_export(const MapView& map, const ExportOptions& options);

}  // namespace camloc::mapping
