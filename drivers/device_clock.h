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

}  // namespace camloc
