// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// When a frame was taken, in CLOCK_MONOTONIC, from the stamp of the device's own clock and the time of arrival. Arrivals are
// late by a delay that varies (USB, scheduling) but has a floor; the device's clock runs evenly but faster or slower. So the
// line under the points (device time, arrival - device time) that touches them is the relation of the clocks (Moon, Skelly and
// Towsley, "Estimation and removal of clock skew from network delay measurements", 1999): the lower hull of the smallest delay
// of each second, at its edge over the mean time. The floor itself cannot be seen from here and stays in the result.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>

namespace camloc {

/// Not thread-safe; never allocates.
class DeviceClock {
 public:
  /// Time of a frame that the device stamped with `device_ns` (any zero, not wrapped around) and that arrived at `arrival_ns`:
  /// at most the arrival, and later than the result before. Starts anew where the device's clock jumps by more than a second.
  std::int64_t to_monotonic(std::int64_t device_ns, std::int64_t arrival_ns);

  /// How much faster the device's clock runs than CLOCK_MONOTONIC; 0 until ten seconds have been seen.
  [[nodiscard]] double drift_ppm() const { return -slope_ * 1e6; }
  /// Forgets everything, after a restart of the device.
  void reset() { *this = DeviceClock(); }

 private:
  /// Delay (arrival - device time) against device time, both since the first frame, in nanoseconds.
  struct Point {
    double device_ns = 0;
    double delay_ns = 0;
  };
  static constexpr std::size_t kMaxPoints = 120;
  static constexpr std::int64_t kPointSpanNs = 1'000'000'000;

  [[nodiscard]] bool is_jump(std::int64_t device_ns, std::int64_t arrival_ns) const;
  void add(const Point& point);
  void fit();

  bool is_started_ = false;
  std::int64_t first_device_ns_ = 0, first_arrival_ns_ = 0;
  std::int64_t last_device_ns_ = 0, last_arrival_ns_ = 0;
  std::int64_t last_result_ns_ = 0;
  std::array<Point, kMaxPoints> points_{};  // the smallest delay of each second, oldest first; the last one is still open
  std::size_t num_points_ = 0;
  double open_until_ns_ = 0;
  double slope_ = 0, base_ns_ = 0;  // delay floor at device time t: base_ns_ + slope_ * t
};

/// When was it? From a counter of 32 bits that runs free in the device, and wraps (every 72 s at 60 MHz), to CLOCK_MONOTONIC.
/// DeviceClock knows the relation of two even clocks; here are the wraps, and the jumps that are too small for it.
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

/// CLOCK_MONOTONIC.
[[nodiscard]] inline std::int64_t steady_now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace camloc
