// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What a map build says: a progress line while it runs, a table or JSON when it is done.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "core/map/map_builder.h"
#include "core/map/map_data.h"

namespace camloc::map_tool {

struct BuildSummary {
  std::string map_path, sequence, camera;
  std::uint64_t num_recorded = 0, num_selected = 0, num_without_pose = 0, num_without_depth = 0, num_broken = 0;
  MapBuildReport build;
  double pose_sigma_m = 0, pose_sigma_rad = 0;
  double seconds = 0;
};

[[nodiscard]] std::string format_table(const BuildSummary& summary);
[[nodiscard]] std::string format_json(const BuildSummary& summary);

/// A line on stderr that is written over and over; silent when stderr is no terminal.
class ProgressLine {
 public:
  explicit ProgressLine(std::uint64_t num_frames);
  ~ProgressLine();
  void show(std::uint64_t frame, const MapBuildReport& report);
  /// Replaces the bar by a text.
  void say(const std::string& text);

 private:
  bool is_terminal_;
  std::uint64_t num_frames_;
  std::chrono::steady_clock::time_point start_, last_shown_;
};

}  // namespace camloc::map_tool
