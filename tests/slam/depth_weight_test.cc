// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/slam/depth_weight.h"

#include <gtest/gtest.h>

#include "core/slam/slam_numbers.h"

namespace camloc {
namespace {

constexpr double kMedianOfNormal = 0.6745;

/// Windows of a camera whose depth scatters by this much, adjusted with what the weight says at the time.
double quadratic_after(int num_windows, double quadratic_of_file, double quadratic_of_scatter) {
  DepthWeight weight(SlamNumbers{}.depth_share);
  const DepthNoise file{0, quadratic_of_file};
  for (int i = 0; i < num_windows; ++i) { weight.observe(kMedianOfNormal * quadratic_of_scatter / weight.weighted(file).quadratic_per_m); }
  return weight.weighted(file).quadratic_per_m;
}

TEST(DepthWeight, WhatIsObservedCountsNotWhatTheFileSays) {
  const double strict = quadratic_after(100, 0.002, 0.0015), lax = quadratic_after(100, 0.006, 0.0015);
  EXPECT_NEAR(strict, lax, 0.02 * lax);
  EXPECT_LT(lax, 0.0015);
  EXPECT_GT(lax, 0.0005);
}

TEST(DepthWeight, FollowsTheScatter) { EXPECT_NEAR(quadratic_after(100, 0.006, 0.003) / quadratic_after(100, 0.006, 0.0015), 2, 0.05); }

TEST(DepthWeight, StaysWithinWhatTheFileMakesPlausible) {
  DepthWeight fresh(SlamNumbers{}.depth_share);
  const DepthNoise file{0.001, 0.006};
  EXPECT_LT(fresh.weighted(file).sigma_m(2), file.sigma_m(2));
  EXPECT_LE(quadratic_after(100, 0.006, 1.0), 0.006);
  EXPECT_GE(quadratic_after(100, 0.006, 1e-9), 0.0003);
}

TEST(DepthWeight, AWindowWithoutDepthSaysNothing) {
  DepthWeight weight(SlamNumbers{}.depth_share);
  const DepthNoise file{0.001, 0.006};
  const double before = weight.weighted(file).sigma_m(2);
  weight.observe(0);
  EXPECT_EQ(weight.weighted(file).sigma_m(2), before);
}

}  // namespace
}  // namespace camloc
