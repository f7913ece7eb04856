// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/keypoint_noise.h"

#include <gtest/gtest.h>

namespace camloc {
namespace {

TEST(KeypointNoise, GrowsWithTheLevelButFarLessThanItsScale) {
  const PyramidLevels levels(1.2F, 8);
  EXPECT_FLOAT_EQ(levels.sigma_px(0), 0.6F);
  for (std::uint8_t level = 1; level < 8; ++level) {
    EXPECT_NEAR(levels.scale(level), std::pow(1.2, level), 1e-5);
    EXPECT_NEAR(levels.sigma_px(level), 0.6 + 0.25 * (std::pow(1.2, level) - 1), 1e-5);
    EXPECT_GT(levels.sigma_px(level), levels.sigma_px(static_cast<std::uint8_t>(level - 1)));
  }
  EXPECT_LT(levels.sigma_px(7) / levels.sigma_px(0), 0.6 * levels.scale(7));
}

TEST(KeypointNoise, ALandmarkThatIsTakenAsItIsAddsItsOwnError) {
  const PyramidLevels levels(1.2F, 8);
  for (std::uint8_t level = 0; level < 8; ++level)
    EXPECT_NEAR(std::pow(pair_sigma_px(levels.scale(level), 1.25F), 2), std::pow(levels.sigma_px(level), 2) + 1.25 * 1.25, 1e-5);
}

TEST(KeypointNoise, LevelsBeyondThePyramidAreItsLast) {
  const PyramidLevels levels(1.2F, 4);
  EXPECT_EQ(levels.num_levels(), 4);
  EXPECT_EQ(levels.scale(200), levels.scale(3));
  EXPECT_NEAR(levels.log_scale(), std::log(1.2), 1e-6);
}

}  // namespace
}  // namespace camloc
