// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Keeps the daemon's status. The service counts into it; once a second it is brought up to date and published.
#pragma once

#include <cstdint>
#include <string>

#include "core/base/unique_fd.h"
#include "core/localize/localization.h"
#include "daemon/capture_thread.h"
#include "daemon/latency_window.h"
#include "daemon/pose_report.h"

namespace camloc {

/// Allocates at construction and in set_map() only.
class StatusBoard {
 public:
  StatusBoard(const std::string& source, const std::string& map_path, std::int64_t now_ns);

  /// For counting; state and texts only through the functions below.
  [[nodiscard]] DaemonStatus& counters() { return status_; }
  [[nodiscard]] const DaemonStatus& get() const { return status_; }

  void add_frame(const Localization& localization, std::int64_t latency_ns);
  /// Texts longer than 255 bytes are cut. True when the state, not only the text, is another one.
  bool set_state(State state, const char* text);
  [[nodiscard]] State state() const { return status_.state; }
  void set_map(const std::string& path, std::uint64_t map_id);
  void set_camera_state(const char* text) { status_.camera_state = text; }
  void set_capture(const CaptureCounts& counts, const FrameSourceHealth& health, std::uint64_t num_dropped);
  void set_calibration(const CalibrationHealth& health);

  /// Closes the one-second window of rate and latency, and reads the process' memory.
  void close_window(std::int64_t now_ns);
  /// Stamps the record, before it leaves.
  void stamp(std::int64_t now_ns, std::int64_t now_epoch_ns);

 private:
  DaemonStatus status_;
  LatencyWindow latency_;
  UniqueFd memory_fd_;  // /proc/self/statm
  std::int64_t started_ns_;
};

}  // namespace camloc
