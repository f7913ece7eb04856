// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// See counter_clock.h.
#include "drivers/kinect/counter_clock.h"

#include <cmath>

namespace camloc::kinect {

void CounterClock::reset() {
  is_started_ = false;
  num_late_ = 0;
  clock_.reset();
}

// The host's clock tells how often the counter wrapped since the last stamp: the count nearest to what it says.
std::int64_t CounterClock::unwrapped_ns(std::uint32_t stamp, std::int64_t arrival_ns) {
  constexpr double kPeriod = 4294967296.0;
  const std::uint32_t step = stamp - last_stamp_;
  const double expected = static_cast<double>(arrival_ns - last_arrival_ns_) / ns_per_tick_;
  const double num_wraps = std::round((expected - step) / kPeriod);
  ticks_ += static_cast<std::int64_t>(step) + static_cast<std::int64_t>(num_wraps * kPeriod);
  last_stamp_ = stamp;
  last_arrival_ns_ = arrival_ns;
  return static_cast<std::int64_t>(std::llround(static_cast<double>(ticks_) * ns_per_tick_));
}

bool CounterClock::has_jumped(std::int64_t device_ns, std::int64_t arrival_ns) {
  const std::int64_t delay_ns = arrival_ns - device_ns - floor_ns_;
  num_late_ = delay_ns > kMaxLateNs ? num_late_ + 1 : 0;
  const bool runs_back = device_ns < last_device_ns_;
  last_device_ns_ = device_ns;
  return runs_back || delay_ns < -kMaxEarlyNs || num_late_ >= kLateRun;
}

std::int64_t CounterClock::host_time_ns(std::uint32_t stamp, std::int64_t arrival_ns) {
  if (!is_started_) {
    is_started_ = true;
    last_stamp_ = stamp;
    last_arrival_ns_ = arrival_ns;
    ticks_ = 0;
    last_device_ns_ = 0;
    floor_ns_ = arrival_ns;
  }
  const std::int64_t device_ns = unwrapped_ns(stamp, arrival_ns);
  if (has_jumped(device_ns, arrival_ns)) {
    ++num_jumps_;
    num_late_ = 0;
    clock_.reset();
  }
  const std::int64_t result_ns = clock_.to_monotonic(device_ns, arrival_ns);
  floor_ns_ = result_ns - device_ns;
  return result_ns;
}

}  // namespace camloc::kinect
