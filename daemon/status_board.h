// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Keeps the daemon's status. The service counts into it; once a second it is brought up to date and published.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>

#include "core/base/unique_fd.h"
#include "core/localize/localization.h"
#include "daemon/capture_thread.h"
#include "daemon/pose_report.h"

namespace camloc {

/// Frame rate and latency over the last second, in fixed memory: collects for a while, then summarize() empties it. Beyond kCapacity frames
/// in a window the earliest are kept for the median; maximum and rate count all.
class LatencyWindow {
 public:
  struct Summary {
    double rate_hz = 0, p50_ms = 0, max_ms = 0;
  };

  explicit LatencyWindow(std::int64_t now_ns) : since_ns_(now_ns) {}

  void add(std::int64_t latency_ns) {
    if (count_ < kCapacity) latencies_ns_[count_] = latency_ns;
    ++count_;
    max_ns_ = std::max(max_ns_, latency_ns);
  }

  [[nodiscard]] Summary summarize(std::int64_t now_ns) {
    Summary summary;
    const std::size_t kept = std::min(count_, kCapacity);
    if (now_ns > since_ns_) summary.rate_hz = 1e9 * static_cast<double>(count_) / static_cast<double>(now_ns - since_ns_);
    if (kept > 0) {
      const auto middle = latencies_ns_.begin() + static_cast<std::ptrdiff_t>(kept / 2);
      std::nth_element(latencies_ns_.begin(), middle, latencies_ns_.begin() + static_cast<std::ptrdiff_t>(kept));
      summary.p50_ms = 1e-6 * static_cast<double>(*middle);
      summary.max_ms = 1e-6 * static_cast<double>(max_ns_);
    }
    *this = LatencyWindow(now_ns);
    return summary;
  }

 private:
  static constexpr std::size_t kCapacity = 256;

  std::array<std::int64_t, kCapacity> latencies_ns_{};
  std::size_t count_ = 0;
  std::int64_t max_ns_ = 0;
  std::int64_t since_ns_;
};

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
  void set_capture(const CaptureCounts& counts, std::uint64_t num_dropped);

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
