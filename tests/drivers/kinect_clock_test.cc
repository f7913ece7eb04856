// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "drivers/device_clock.h"
#include "drivers/kinect/kinect_protocol.h"

namespace camloc::kinect {
namespace {

constexpr std::int64_t kFrameNs = 33'333'333, kStartNs = 5'000'000'000'000;
constexpr std::int64_t kTransportNs = 1'000'000;  // least delay, which nobody can see

/// A 60 MHz counter that runs fast by `drift` and stood at `first` at kStartNs.
struct Counter {
  double drift = 0;
  std::uint32_t first = 0;
  [[nodiscard]] std::uint32_t at(std::int64_t time_ns) const {
    const double ticks = static_cast<double>(time_ns - kStartNs) * 0.06 * (1 + drift);
    return first + static_cast<std::uint32_t>(static_cast<std::uint64_t>(std::llround(ticks)));
  }
};

/// Delays as USB and scheduling make them: mostly short, now and then very long.
std::int64_t delay_ns(std::mt19937* random) {
  const double jitter_ns = std::exponential_distribution<double>(1.0 / 1.5e6)(*random);
  const bool is_hiccup = std::bernoulli_distribution(0.01)(*random);
  return kTransportNs + static_cast<std::int64_t>(jitter_ns) + (is_hiccup ? 40'000'000 : 0);
}

TEST(CounterClock, FindsCaptureTimesUnderJitterDriftAndWraps) {
  for (const double drift : {0.0, 80e-6, -80e-6}) {
    CounterClock clock(kDeviceClockHz);
    const Counter counter{drift, 0xfff0'0000U};  // wraps at once, then every 72 s
    std::mt19937 random(1);
    double worst_ns = 0;
    std::int64_t last_ns = 0;
    for (int i = 0; i < 300 * 30; ++i) {
      const std::int64_t captured_ns = kStartNs + i * kFrameNs, arrival_ns = captured_ns + delay_ns(&random);
      const std::int64_t estimate_ns = clock.host_time_ns(counter.at(captured_ns), arrival_ns);
      EXPECT_LE(estimate_ns, arrival_ns);
      EXPECT_GT(estimate_ns, last_ns);
      last_ns = estimate_ns;
      if (i > 15 * 30) worst_ns = std::max(worst_ns, std::abs(static_cast<double>(estimate_ns - kTransportNs - captured_ns)));
    }
    EXPECT_LT(worst_ns, 1e6) << drift;
    EXPECT_NEAR(clock.drift_ppm(), drift * 1e6, 5) << drift;
    EXPECT_EQ(clock.num_jumps(), 0U);
  }
}

TEST(CounterClock, PausesOfAnyLengthAreBridged) {
  CounterClock clock(kDeviceClockHz);
  const Counter counter;
  std::int64_t time_ns = kStartNs;
  for (const std::int64_t pause_s : {0LL, 1LL, 36LL, 71LL, 72LL, 500LL}) {
    time_ns += pause_s * 1'000'000'000;
    for (int i = 0; i < 60; ++i, time_ns += kFrameNs) {
      EXPECT_NEAR(static_cast<double>(clock.host_time_ns(counter.at(time_ns), time_ns + kTransportNs)),
                  static_cast<double>(time_ns + kTransportNs), 1e5);
    }
  }
  EXPECT_EQ(clock.num_jumps(), 0U);
}

TEST(CounterClock, JumpsOfTheCounterAreFound) {
  for (const double jump_s : {0.05, 0.5, 3.0, 30.0, -0.2, -0.5, -3.0, -30.0}) {
    CounterClock clock(kDeviceClockHz);
    const Counter before;
    Counter after;
    after.first = static_cast<std::uint32_t>(static_cast<std::int64_t>(jump_s * kDeviceClockHz));
    std::int64_t error_ns = 0;
    for (int i = 0; i < 200; ++i) {
      const std::int64_t time_ns = kStartNs + i * kFrameNs;
      const std::int64_t estimate_ns = clock.host_time_ns((i < 100 ? before : after).at(time_ns), time_ns + kTransportNs);
      EXPECT_LE(estimate_ns, time_ns + kTransportNs);
      error_ns = time_ns + kTransportNs - estimate_ns;
    }
    EXPECT_LT(error_ns, 1'000'000) << jump_s;
    EXPECT_GE(clock.num_jumps(), 1U) << jump_s;
  }
}

TEST(CounterClock, ABusyHostIsNoJump) {
  CounterClock clock(kDeviceClockHz);
  const Counter counter;
  std::int64_t worst_ns = 0;
  for (int i = 0; i < 300; ++i) {
    const std::int64_t captured_ns = kStartNs + i * kFrameNs;
    // For half a second nothing is handled, then all at once.
    const bool is_held = i >= 100 && i < 109;
    const std::int64_t arrival_ns = is_held ? kStartNs + 109 * kFrameNs + i * 1000 : captured_ns + kTransportNs;
    const std::int64_t estimate_ns = clock.host_time_ns(counter.at(captured_ns), arrival_ns);
    worst_ns = std::max(worst_ns, std::abs(estimate_ns - kTransportNs - captured_ns));
  }
  EXPECT_LT(worst_ns, 200'000);
  EXPECT_EQ(clock.num_jumps(), 0U);
}

}  // namespace
}  // namespace camloc::kinect
