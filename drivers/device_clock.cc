// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/device_clock.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace camloc {

namespace {

constexpr double kMinFitSpanNs = 10e9;  // over less, one late second bends the line more than the clocks differ
constexpr double kMaxSlope = 500e-6;    // crystals are good to 100 ppm

}  // namespace

std::int64_t DeviceClock::to_monotonic(std::int64_t device_ns, std::int64_t arrival_ns) {
  if (is_started_ && is_jump(device_ns, arrival_ns)) {
    const std::int64_t last_result_ns = last_result_ns_;
    reset();
    last_result_ns_ = last_result_ns;
  }
  if (!is_started_) {
    is_started_ = true;
    first_device_ns_ = device_ns;
    first_arrival_ns_ = arrival_ns;
  }
  last_device_ns_ = device_ns;
  last_arrival_ns_ = arrival_ns;
  const std::int64_t device_since_ns = device_ns - first_device_ns_;
  const std::int64_t delay_ns = arrival_ns - first_arrival_ns_ - device_since_ns;
  const double t = static_cast<double>(device_since_ns);
  add({t, static_cast<double>(delay_ns)});
  const auto floor_ns = static_cast<std::int64_t>(std::llround(base_ns_ + slope_ * t));
  // A new floor may lie below the last one by more than a frame: then time stands still rather than run backwards.
  const std::int64_t result_ns = std::min(first_arrival_ns_ + device_since_ns + floor_ns, arrival_ns);
  last_result_ns_ = std::max(result_ns, last_result_ns_ + 1);
  return last_result_ns_;
}

bool DeviceClock::is_jump(std::int64_t device_ns, std::int64_t arrival_ns) const {
  constexpr std::int64_t kJumpNs = 1'000'000'000;
  const std::int64_t step_ns = device_ns - last_device_ns_;
  // A host that was busy for a second shows a step of arrivals alone; the next arrivals then come close together, never
  // earlier than the floor.
  const std::int64_t lead_ns = step_ns - (arrival_ns - last_arrival_ns_);
  return step_ns < 0 || lead_ns > kJumpNs || lead_ns < -10 * kJumpNs;
}

void DeviceClock::add(const Point& point) {
  if (num_points_ > 0 && point.device_ns < open_until_ns_) {
    Point& open = points_[num_points_ - 1];
    if (point.delay_ns >= open.delay_ns) return;
    open = point;
  } else {
    if (num_points_ == kMaxPoints) {
      std::move(points_.begin() + 1, points_.end(), points_.begin());
      --num_points_;
    }
    points_[num_points_++] = point;
    open_until_ns_ = point.device_ns + static_cast<double>(kPointSpanNs);
  }
  fit();
}

void DeviceClock::fit() {
  const auto begin = points_.begin();
  const auto end = begin + static_cast<std::ptrdiff_t>(num_points_);
  const auto is_lower = [](const Point& a, const Point& b) { return a.delay_ns < b.delay_ns; };
  slope_ = 0;
  base_ns_ = std::min_element(begin, end, is_lower)->delay_ns;
  if (points_[num_points_ - 1].device_ns - points_[0].device_ns < kMinFitSpanNs) return;
  // Lower hull, from left to right (Andrew's monotone chain).
  std::array<Point, kMaxPoints> hull;
  std::size_t size = 0;
  double mean_device_ns = 0;
  for (auto p = begin; p != end; ++p) {
    mean_device_ns += p->device_ns / static_cast<double>(num_points_);
    const auto turns_right = [&hull, &size, p] {
      const Point &a = hull[size - 2], &b = hull[size - 1];
      return (b.device_ns - a.device_ns) * (p->delay_ns - a.delay_ns) <= (b.delay_ns - a.delay_ns) * (p->device_ns - a.device_ns);
    };
    while (size >= 2 && turns_right()) --size;
    hull[size++] = *p;
  }
  std::size_t right = 1;
  while (right + 1 < size && hull[right].device_ns < mean_device_ns) ++right;
  const Point &a = hull[right - 1], &b = hull[right];
  const double slope = (b.delay_ns - a.delay_ns) / (b.device_ns - a.device_ns);
  if (std::abs(slope) > kMaxSlope) return;
  slope_ = slope;
  base_ns_ = a.delay_ns - slope * a.device_ns;
}

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

}  // namespace camloc
