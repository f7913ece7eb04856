// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Poses and status of camlocd as text: a line, a JSON record, a screen. No I/O here.
#pragma once

#include <array>
#include <camloc/pose_t.hpp>
#include <camloc/status_t.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace camloc::tools {

/// NO_CAMERA, NO_MAP, LOST, COARSE, LOCALIZED, COASTING; "state 42" for what this build does not know.
[[nodiscard]] std::string state_name(int state);

/// Largest standard deviation over all directions: position (metres) and rotation (radians).
struct PoseSigma {
  double position_m = 0;
  double rotation_rad = 0;
};
[[nodiscard]] PoseSigma pose_sigma(const pose_t& pose);

/// Without a newline.
[[nodiscard]] std::string pose_line(const pose_t& pose);
[[nodiscard]] std::string status_line(const status_t& status);
/// Every field of the message, and "type": "pose" or "status", "state_name".
[[nodiscard]] nlohmann::json pose_json(const pose_t& pose);
[[nodiscard]] nlohmann::json status_json(const status_t& status);

/// Durations of the localizer's stages over the last poses.
class StageLatencies {
 public:
  static constexpr std::size_t kNumStages = 6;  ///< as in pose_t: extract, candidates, match, estimate, verify, total
  void add(const pose_t& pose);
  struct Summary {
    double median_ms = 0, p99_ms = 0;
  };
  [[nodiscard]] Summary of(std::size_t stage) const;

 private:
  static constexpr std::size_t kWindow = 300;  // ten seconds of a camera
  std::array<std::vector<double>, kNumStages> durations_ms_;
  std::size_t next_ = 0;
};

/// What the live view knows. `rate_hz` counts poses as they arrive.
struct MonitorState {
  std::optional<pose_t> pose;
  std::optional<status_t> status;
  StageLatencies latencies;
  long long num_poses = 0;
  long long num_localized = 0;
  double rate_hz = 0;
  double seconds_since_pose = 0;
  std::string sketch;  ///< the map from above, where it can be read here
};
/// Some twenty lines and the sketch, each ended by "\n".
[[nodiscard]] std::string monitor_screen(const MonitorState& state);

}  // namespace camloc::tools
