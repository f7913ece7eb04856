// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Device clocks with known drift behind transports with known delays.
#include "drivers/device_clock.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <random>

namespace camloc {
namespace {

constexpr double kSecond = 1e9;

/// A device that starts at a stamp of its own, runs fast by `drift_ppm`, and a transport of 4 ms and more.
struct Simulation {
  double drift_ppm = 0;
  double mean_extra_delay_ns = 3e6;
  std::mt19937 random{7};
  std::int64_t device_zero_ns = 123'456'789'000;
  std::int64_t host_zero_ns = 987'654'321'000'000;

  static constexpr std::int64_t kFloorNs = 4'000'000;
  struct Frame {
    std::int64_t taken_ns, device_ns, arrival_ns;
  };
  Frame at(double since_start_ns) {
    const double delay_ns = static_cast<double>(kFloorNs) + std::exponential_distribution<double>(1 / mean_extra_delay_ns)(random);
    return {host_zero_ns + static_cast<std::int64_t>(since_start_ns),
            device_zero_ns + static_cast<std::int64_t>(since_start_ns * (1 + drift_ppm * 1e-6)),
            host_zero_ns + static_cast<std::int64_t>(since_start_ns + delay_ns)};
  }
};

class DeviceClockDrift : public ::testing::TestWithParam<double> {};

TEST_P(DeviceClockDrift, FindsCaptureTimeAndDrift) {
  Simulation simulation;
  simulation.drift_ppm = GetParam();
  DeviceClock clock;
  double worst_ns = 0;
  std::int64_t before_ns = 0;
  for (int i = 0; i < 30 * 300; ++i) {
    const Simulation::Frame frame = simulation.at(i * kSecond / 30);
    const std::int64_t stamp_ns = clock.to_monotonic(frame.device_ns, frame.arrival_ns);
    EXPECT_LE(stamp_ns, std::max(frame.arrival_ns, before_ns + 1));
    EXPECT_GT(stamp_ns, before_ns);
    before_ns = stamp_ns;
    if (i > 30 * 30) worst_ns = std::max(worst_ns, std::abs(static_cast<double>(stamp_ns - frame.taken_ns - Simulation::kFloorNs)));
  }
  EXPECT_NEAR(clock.drift_ppm(), GetParam(), 3);
  EXPECT_LT(worst_ns, 1e6);
}

INSTANTIATE_TEST_SUITE_P(Crystals, DeviceClockDrift, ::testing::Values(-150.0, -20.0, 0.0, 20.0, 150.0));

TEST(DeviceClockTest, FirstFrameIsTakenToArriveAtOnce) {
  DeviceClock clock;
  EXPECT_EQ(clock.to_monotonic(5'000, 1'000'000), 1'000'000);
  EXPECT_EQ(clock.drift_ppm(), 0);
}

TEST(DeviceClockTest, BusySecondDoesNotMoveCaptureTimes) {
  Simulation simulation;
  DeviceClock clock;
  for (int i = 0; i < 600; ++i) {
    Simulation::Frame frame = simulation.at(i * kSecond / 30);
    // The host sleeps for two seconds: what was taken meanwhile arrives together.
    if (i >= 300 && i < 360) frame.arrival_ns = simulation.host_zero_ns + static_cast<std::int64_t>(12 * kSecond) + i;
    const std::int64_t stamp_ns = clock.to_monotonic(frame.device_ns, frame.arrival_ns);
    if (i > 60) { EXPECT_LT(std::llabs(stamp_ns - frame.taken_ns - Simulation::kFloorNs), 2'000'000) << i; }
  }
}

TEST(DeviceClockTest, StartsAnewWhenDeviceClockJumps) {
  for (const std::int64_t jump_ns : {-100'000'000'000, 5'000'000'000}) {
    Simulation simulation;
    DeviceClock clock;
    std::int64_t before_ns = 0;
    for (int i = 0; i < 600; ++i) {
      const Simulation::Frame frame = simulation.at(i * kSecond / 30);
      const std::int64_t stamp_ns = clock.to_monotonic(frame.device_ns + (i < 300 ? 0 : jump_ns), frame.arrival_ns);
      EXPECT_GT(stamp_ns, before_ns);
      before_ns = stamp_ns;
      if (i > 400) { EXPECT_LT(std::llabs(stamp_ns - frame.taken_ns - Simulation::kFloorNs), 2'000'000) << i; }
    }
  }
}

TEST(DeviceClockTest, ResetForgets) {
  DeviceClock clock;
  (void)clock.to_monotonic(0, 1'000'000'000);
  clock.reset();
  EXPECT_EQ(clock.to_monotonic(77, 500'000'000), 500'000'000);
}

}  // namespace
}  // namespace camloc
