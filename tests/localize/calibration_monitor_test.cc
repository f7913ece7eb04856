// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/localize/calibration_monitor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "tests/map/synthetic_map.h"

namespace camloc {
namespace {

constexpr double kSure = 0.01;

TEST(CalibrationMonitor, HealthyAtFirst) {
  const CalibrationMonitor monitor{LocalizerNumbers{}};
  EXPECT_FALSE(monitor.health().is_suspect);
  EXPECT_EQ(monitor.health().focal_scale, 1);
  EXPECT_EQ(monitor.health().num_frames, 0U);
}

TEST(CalibrationMonitor, SuspectsOnlyWithEnoughFrames) {
  CalibrationMonitor monitor{LocalizerNumbers{}};
  for (int i = 1; i <= 20; ++i) {
    monitor.add(1.1, kSure);
    EXPECT_EQ(monitor.health().is_suspect, i >= 8) << i;
    EXPECT_EQ(monitor.health().focal_scale, 1.1);
    EXPECT_EQ(monitor.health().num_frames, static_cast<std::uint32_t>(i));
  }
}

TEST(CalibrationMonitor, LimitHoldsOnBothSides) {
  for (const double scale : {0.964, 1.036}) {
    CalibrationMonitor monitor{LocalizerNumbers{}};
    for (int i = 0; i < 8; ++i) monitor.add(scale, kSure);
    EXPECT_TRUE(monitor.health().is_suspect) << scale;
  }
  for (const double scale : {0.966, 1.0, 1.034}) {
    CalibrationMonitor monitor{LocalizerNumbers{}};
    for (int i = 0; i < 100; ++i) monitor.add(scale, kSure);
    EXPECT_FALSE(monitor.health().is_suspect) << scale;
  }
}

TEST(CalibrationMonitor, IsTheMedianOfTheLast31) {
  CalibrationMonitor monitor{LocalizerNumbers{}};
  testing::Random random(3);
  std::vector<double> all;
  for (int i = 0; i < 200; ++i) {
    all.push_back(random.uniform(0.8, 1.3));
    monitor.add(all.back(), kSure);
    std::vector<double> recent(all.end() - static_cast<std::ptrdiff_t>(std::min<std::size_t>(all.size(), 31)), all.end());
    std::sort(recent.begin(), recent.end());
    ASSERT_EQ(monitor.health().focal_scale, recent[recent.size() / 2]) << i;
  }
}

TEST(CalibrationMonitor, AFewWildFramesChangeNothing) {
  CalibrationMonitor monitor{LocalizerNumbers{}};
  for (int i = 0; i < 200; ++i) {
    monitor.add(i % 5 < 2 ? 3.0 : 1.001, kSure);
    EXPECT_FALSE(monitor.health().is_suspect && i >= 30) << i;
  }
  EXPECT_EQ(monitor.health().focal_scale, 1.001);
}

TEST(CalibrationMonitor, RecoversWhenTheCameraIsRightAgain) {
  CalibrationMonitor monitor{LocalizerNumbers{}};
  for (int i = 0; i < 100; ++i) monitor.add(1.17, kSure);
  for (int i = 0; i < 15; ++i) monitor.add(1, kSure);
  EXPECT_TRUE(monitor.health().is_suspect);
  monitor.add(1, kSure);
  EXPECT_FALSE(monitor.health().is_suspect) << "16 of 31 are right";
}

TEST(CalibrationMonitor, UncertainFramesTakeNoPart) {
  CalibrationMonitor monitor{LocalizerNumbers{}};
  for (const double sigma : {0.03, 0.5, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    for (int i = 0; i < 50; ++i) monitor.add(1.5, sigma);
  }
  EXPECT_EQ(monitor.health().num_frames, 0U);
  EXPECT_FALSE(monitor.health().is_suspect);
  EXPECT_EQ(monitor.health().focal_scale, 1);
}

}  // namespace
}  // namespace camloc
