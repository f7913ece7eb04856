// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/status_board.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <string_view>

namespace camloc {
namespace {

constexpr std::size_t kMaxStateText = 255;

/// Resident memory from an open /proc/self/statm, 0 when it cannot be read.
std::int64_t resident_bytes(int statm_fd) {
  std::array<char, 128> text{};
  if (::pread(statm_fd, text.data(), text.size() - 1, 0) <= 0) return 0;
  long long total = 0, resident = 0;
  if (std::sscanf(text.data(), "%lld %lld", &total, &resident) != 2) return 0;
  return resident * ::sysconf(_SC_PAGESIZE);
}

}  // namespace

StatusBoard::StatusBoard(const std::string& source, const std::string& map_path, std::int64_t now_ns)
    : latency_(now_ns), memory_fd_(::open("/proc/self/statm", O_RDONLY | O_CLOEXEC)), started_ns_(now_ns) {
  status_.source = source;
  status_.map_path = map_path;
  status_.state_text.reserve(kMaxStateText);
  if (!source.empty()) status_.camera_state = to_string(CapturePhase::kOpening);
}

void StatusBoard::add_frame(const Localization& localization, std::int64_t latency_ns) {
  latency_.add(latency_ns);
  if (localization.state != State::kLocalized) return;
  ++status_.frames_localized;
  if (localization.is_tracked) return;
  const std::string_view by = localization.proposed_by;
  if (by == "hint") ++status_.fixes_by_hint;
  if (by == "retrieval") ++status_.fixes_by_retrieval;
  if (by == "coarse") ++status_.fixes_by_coarse;
}

bool StatusBoard::set_state(State state, const char* text) {
  const bool is_other = state != this->state();
  status_.state = state;
  status_.state_text.assign(text, std::min(std::strlen(text), kMaxStateText));
  return is_other;
}

void StatusBoard::set_map(const std::string& path, std::uint64_t map_id) {
  status_.map_path = path;
  status_.map_id = map_id;
}

void StatusBoard::set_capture(const CaptureCounts& counts, std::uint64_t num_dropped) {
  const auto number = [](std::uint64_t count) { return static_cast<std::int64_t>(count); };
  status_.frames_received = number(counts.frames_received);
  status_.frames_corrupt = number(counts.frames_corrupt);
  status_.frames_dropped = number(num_dropped);
  status_.camera_stalls = number(counts.stalls);
  status_.stream_restarts = number(counts.stream_restarts);
  status_.device_reopens = number(counts.device_reopens);
  status_.device_resets = number(counts.device_resets);
  status_.last_recovery_ms = static_cast<double>(counts.last_recovery_ns) * 1e-6;
  status_.packets_lost = number(counts.source.packets_lost);
  status_.frames_incomplete = number(counts.source.frames_incomplete);
  status_.frames_unpaired = number(counts.source.frames_unpaired);
  status_.clock_drift_ppm = counts.source.clock_drift_ppm;
}

void StatusBoard::close_window(std::int64_t now_ns) {
  const LatencyWindow::Summary summary = latency_.summarize(now_ns);
  status_.frame_rate_hz = summary.rate_hz;
  status_.latency_p50_ms = summary.p50_ms;
  status_.latency_max_ms = summary.max_ms;
  status_.rss_bytes = resident_bytes(memory_fd_.get());
}

void StatusBoard::stamp(std::int64_t now_ns, std::int64_t now_epoch_ns) {
  status_.written_epoch_us = now_epoch_ns / 1000;
  status_.uptime_us = (now_ns - started_ns_) / 1000;
}

}  // namespace camloc
