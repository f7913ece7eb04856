// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Releases recorded frames at their recorded times. Deadlines are absolute, so that a late frame does not delay the
// ones after it.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <thread>

namespace camloc {

/// Not thread-safe. With speed 0 nothing ever waits.
class Pacer {
 public:
  explicit Pacer(double speed) : speed_(speed) {}

  /// Waits until `stamp_ns` is due, at most `timeout`; false: not due yet. The first stamp asked for is due at once.
  [[nodiscard]] bool wait_for(std::int64_t stamp_ns, std::chrono::milliseconds timeout) {
    if (speed_ <= 0) return true;
    const Clock::time_point now = Clock::now();
    if (!is_started_) {
      is_started_ = true;
      start_ = now;
      first_stamp_ns_ = stamp_ns;
    }
    const double offset_ns = static_cast<double>(stamp_ns - first_stamp_ns_) / speed_;
    const Clock::time_point due = start_ + std::chrono::nanoseconds(static_cast<std::int64_t>(offset_ns));
    const Clock::time_point until = std::min(due, now + timeout);
    if (until > now) std::this_thread::sleep_until(until);
    return due <= until;
  }

 private:
  using Clock = std::chrono::steady_clock;
  double speed_;
  bool is_started_ = false;
  Clock::time_point start_;
  std::int64_t first_stamp_ns_ = 0;
};

}  // namespace camloc
