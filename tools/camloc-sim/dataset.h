// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A whole data set: mapping walk, another day's walk, LiDAR cloud, camera file, README.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "core/base/result.h"
#include "tools/camloc-sim/walk.h"

namespace camloc::sim {

struct RecordingOptions {
  double rate_hz = 30;
  double duration_scale = 1;  ///< only this share of the walk
  int num_jobs = 1;           ///< threads; the files do not depend on it
  int jpeg_quality = 92;      ///< 0 writes PNG
  std::int64_t start_ns = 1700000000'000000000;
  bool is_perfect = false;  ///< no sensor noise, blur or dropouts
};

/// Called after each frame with frames done and all; from any thread, one at a time.
using Progress = std::function<void(int, int)>;

/// Writes a walk as a TUM RGB-D folder: rgb/, depth/, rgb.txt, depth.txt, groundtruth.txt. Returns the number of frames. `folder` must not
/// exist or be empty.
[[nodiscard]] Result<int> record(const World& world, const RecordingOptions& options, const std::string& folder, const Progress& progress);

struct DatasetOptions {
  SceneKind kind = SceneKind::kBuilding;
  std::uint32_t seed = 1;
  RecordingOptions recording;
  double lidar_step_m = 0.03;  ///< between neighbouring points
  std::string only;            ///< "mapping", "day2" or "lidar": nothing but this part and the camera file
  bool may_overwrite = false;  ///< an existing folder's data set is replaced
};

struct DatasetSummary {
  int num_mapping_frames = 0, num_day2_frames = 0;
  std::uint64_t num_lidar_points = 0;
};

/// Called with the name of the part being written, and how much of it is done.
using DatasetProgress = std::function<void(const std::string&, int, int)>;

[[nodiscard]] Result<DatasetSummary> write_dataset(const std::string& folder, const DatasetOptions& options,
                                                   const DatasetProgress& progress);

/// A survey's point cloud of everything that does not move: points spread evenly over the surfaces, in the world frame. Binary
/// little-endian PLY: float x y z, uchar intensity. Returns the number of points. Surfaces nobody would scan (inside of furniture
/// against a wall) are not left out.
[[nodiscard]] Result<std::uint64_t> write_lidar_ply(const std::string& path, const Scene& scene, double step_m, std::uint32_t seed);

}  // namespace camloc::sim
