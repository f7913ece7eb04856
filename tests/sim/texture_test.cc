// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/camloc-sim/texture.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tools/camloc-sim/noise.h"

namespace camloc::sim {
namespace {

struct Spread {
  double mean = 0, sigma = 0;
};

Spread spread_of(const Skin& skin, float foot_m) {
  double sum = 0, squares = 0;
  constexpr int kCount = 60;
  for (int j = 0; j < kCount; ++j) {
    for (int i = 0; i < kCount; ++i) {
      const double tone =
          texture_tone(skin, {0.8F * static_cast<float>(i) / kCount, 0.8F * static_cast<float>(j) / kCount, 0.8F, 0.8F, foot_m});
      sum += tone;
      squares += tone * tone;
    }
  }
  const double mean = sum / (kCount * kCount);
  return {mean, std::sqrt(std::max(0.0, squares / (kCount * kCount) - mean * mean))};
}

TEST(Texture, FromFarAwayDetailFadesAndTheMeanStays) {
  for (const Material material : {Material::kCarpet, Material::kTiles, Material::kCeiling, Material::kKeyboard, Material::kBrick}) {
    const Skin skin{material, 7, 0.5F};
    const Spread near = spread_of(skin, 0.0005F), far = spread_of(skin, 0.5F);
    EXPECT_LT(far.sigma, 0.6 * near.sigma) << static_cast<int>(material);
    EXPECT_NEAR(far.mean, near.mean, 0.12) << static_cast<int>(material);
  }
}

TEST(Texture, PostersHaveContrastAndBlankWallsHaveNone) {
  EXPECT_GT(spread_of({Material::kPoster, 3, 0.5F}, 0.002F).sigma, 0.15);
  EXPECT_GT(spread_of({Material::kBooks, 3, 0.5F}, 0.002F).sigma, 0.15);
  EXPECT_LT(spread_of({Material::kBlank, 3, 0.7F}, 0.002F).sigma, 0.01);
}

TEST(Texture, AnotherSeedIsAnotherPoster) {
  int num_different = 0;
  for (float u = 0.01F; u < 0.6F; u += 0.02F) {
    num_different += std::fabs(texture_tone({Material::kPoster, 1, 0.5F}, {u, 0.4F, 0.6F, 0.9F, 0.002F}) -
                               texture_tone({Material::kPoster, 2, 0.5F}, {u, 0.4F, 0.6F, 0.9F, 0.002F})) > 0.05F;
  }
  EXPECT_GT(num_different, 15);
}

TEST(Pattern, LatticeIsTheAverageOverThePixel) {
  const auto cell = [](int i, int j) { return static_cast<float>((i + j) & 1); };
  EXPECT_FLOAT_EQ(filtered_lattice(0.5F, 0.5F, 0.2F, 0.5F, cell), 0.0F);
  EXPECT_FLOAT_EQ(filtered_lattice(1.5F, 0.5F, 0.2F, 0.5F, cell), 1.0F);
  EXPECT_NEAR(filtered_lattice(1.0F, 0.5F, 0.2F, 0.5F, cell), 0.5F, 1e-5);
  EXPECT_NEAR(filtered_lattice(-1.05F, 0.5F, 0.2F, 0.5F, cell), 0.25F, 1e-5);
  EXPECT_FLOAT_EQ(filtered_lattice(1.5F, 0.5F, 3.0F, 0.5F, cell), 0.5F);
}

TEST(Pattern, ThinLinesKeepTheirShareOfThePixel) {
  EXPECT_NEAR(covered_lines(0.0F, 1.0F, 0.01F, 0.1F), 0.1F, 1e-4);
  EXPECT_NEAR(covered_lines(3.0F, 1.0F, 0.5F, 0.1F), 1.0F, 1e-4);
  EXPECT_NEAR(covered_lines(0.5F, 1.0F, 0.2F, 0.1F), 0.0F, 1e-4);
}

}  // namespace
}  // namespace camloc::sim
