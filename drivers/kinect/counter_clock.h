// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// When was it? From a counter of 32 bits that runs free in the device, and wraps (every 72 s at 60 MHz), to CLOCK_MONOTONIC.
// DeviceClock knows the relation of two even clocks; here are the wraps, and the jumps that are too small for it.
#pragma once

#include <cstdint>

#include "drivers/device_clock.h"

namespace camloc::kinect {

/// Not thread-safe, never allocates, reads no clock.
class CounterClock {
 public:
  explicit CounterClock(double ticks_per_second) : ns_per_tick_(1e9 / ticks_per_second) {}

  /// The time at which the counter stood at `stamp`, given that word of it came at `arrival_ns`; never later than that. Arrivals
  /// ascend, with pauses of any length.
  [[nodiscard]] std::int64_t host_time_ns(std::uint32_t stamp, std::int64_t arrival_ns);

  [[nodiscard]] double drift_ppm() const { return clock_.drift_ppm(); }
  /// Times the counter was found to have jumped; the relation of the clocks is measured anew then.
  [[nodiscard]] std::uint64_t num_jumps() const { return num_jumps_; }
  /// Forgets everything but the number of jumps: after a restart of the device.
  void reset();

  /// Data may be late by as much as the host was busy, but not by this much for kLateRun frames in a row: the counter jumped
  /// back.
  static constexpr std::int64_t kMaxLateNs = 100'000'000;
  static constexpr int kLateRun = 10;
  /// Nor may they come before they were taken: the counter jumped ahead.
  static constexpr std::int64_t kMaxEarlyNs = 20'000'000;

 private:
  [[nodiscard]] std::int64_t unwrapped_ns(std::uint32_t stamp, std::int64_t arrival_ns);
  [[nodiscard]] bool has_jumped(std::int64_t device_ns, std::int64_t arrival_ns);

  double ns_per_tick_;
  DeviceClock clock_;
  bool is_started_ = false;
  std::uint32_t last_stamp_ = 0;
  std::int64_t last_arrival_ns_ = 0;
  std::int64_t ticks_ = 0;     ///< unwrapped, since the start
  std::int64_t floor_ns_ = 0;  ///< estimate of arrival minus device time for data without delay, from the last result
  std::int64_t last_device_ns_ = 0;
  int num_late_ = 0;
  std::uint64_t num_jumps_ = 0;
};

}  // namespace camloc::kinect
