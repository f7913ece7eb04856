// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A whole data set: mapping walk, another day's walk, LiDAR cloud, camera file, README.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "core/base/result.h"
#include "tools/camloc-sim/lidar.h"
#include "tools/camloc-sim/recorder.h"

namespace camloc::sim {

struct DatasetOptions {
  SceneKind kind = SceneKind::kBuilding;
  std::uint32_t seed = 1;
  RecordingOptions recording;
  LidarOptions lidar;
  bool has_mapping = true, has_day2 = true, has_lidar = true;
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

}  // namespace camloc::sim
