// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What a map build says: a table or JSON when it is done.
#pragma once

#include <cstdint>
#include <string>

#include "core/map/map_builder.h"
#include "core/map/map_data.h"

namespace camloc::map_tool {

struct BuildSummary {
  std::string map_path, sequence, camera;
  std::uint64_t num_recorded = 0, num_selected = 0, num_without_pose = 0, num_without_depth = 0, num_broken = 0;
  std::string first_broken;  ///< what was wrong with the first broken frame
  MapBuildReport build;
  double pose_sigma_m = 0, pose_sigma_rad = 0;
  double seconds = 0;
};

[[nodiscard]] std::string format_table(const BuildSummary& summary);
[[nodiscard]] std::string format_json(const BuildSummary& summary);

}  // namespace camloc::map_tool
