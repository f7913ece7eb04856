// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Frame rate and latency over the last second, in fixed memory.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

namespace camloc {

/// Collects for a while, then summarize() empties it. Beyond kCapacity frames in a window the earliest are kept for the
/// median; maximum and rate count all.
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

}  // namespace camloc
