// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The scale of a model is found under noise and outliers, and is refused where the numbers contradict each other.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/map/synthetic_map.h"
#include "tools/mapping/colmap/colmap_model.h"

namespace camloc::mapping {
namespace {

/// `noise` is relative; every `outlier_step`-th pair is nonsense.
std::vector<DepthPair> make_pairs(double scale, double noise, int outlier_step, std::uint32_t num_images = 10) {
  testing::Random random(3);
  std::vector<DepthPair> pairs;
  for (std::uint32_t image = 0; image < num_images; ++image) {
    for (int i = 0; i < 40; ++i) {
      const double depth = random.uniform(1, 5);
      double measured = scale * depth * (1 + random.uniform(-noise, noise));
      if (outlier_step > 0 && i % outlier_step == 0) measured = random.uniform(0.5, 8);
      pairs.push_back({image, depth, measured});
    }
  }
  return pairs;
}

TEST(ModelScaleTest, FindsTheScale) {
  for (const double truth : {0.01, 0.37, 1.0, 250.0}) {
    const auto scale = estimate_model_scale(make_pairs(truth, 0.03, 0));
    ASSERT_TRUE(scale.is_ok());
    EXPECT_NEAR(scale->metres_per_unit / truth, 1, 0.005);
    EXPECT_LT(scale->spread, 0.03);
    EXPECT_LT(scale->image_spread, 0.02);
    EXPECT_EQ(scale->num_pairs, 400U);
    EXPECT_EQ(scale->num_images, 10U);
  }
}

TEST(ModelScaleTest, IsDescribedInOneLine) {
  const ModelScale scale{0.27101, 0.0123, 0.004, 801, 60};
  EXPECT_EQ(describe_scale(scale), "0.271 m a unit, from 801 points in 60 images; scatter 1.2 %, drift between images 0.4 %");
}

TEST(ModelScaleTest, AFifthOfTheDepthsMayBeWrong) {
  const auto scale = estimate_model_scale(make_pairs(0.5, 0.03, 5));
  ASSERT_TRUE(scale.is_ok()) << scale.status().message();
  EXPECT_NEAR(scale->metres_per_unit / 0.5, 1, 0.02);
}

TEST(ModelScaleTest, RefusesDepthOfAnotherPlace) {
  const auto scale = estimate_model_scale(make_pairs(0.5, 0.03, 1));
  EXPECT_EQ(scale.status().code(), ErrorCode::kInvalid);
  EXPECT_NE(scale.status().message().find("scatters"), std::string::npos) << scale.status().message();
}

TEST(ModelScaleTest, RefusesAModelWhoseScaleDrifts) {
  std::vector<DepthPair> pairs = make_pairs(0.5, 0.01, 0, 20);
  for (DepthPair& pair : pairs) pair.measured_depth_m *= 1 + 0.012 * pair.image;
  const auto scale = estimate_model_scale(pairs);
  ASSERT_FALSE(scale.is_ok());
  EXPECT_NE(scale.status().message().find("drifts"), std::string::npos) << scale.status().message();
}

TEST(ModelScaleTest, RefusesTooFewPairs) {
  EXPECT_FALSE(estimate_model_scale({}).is_ok());
  EXPECT_FALSE(estimate_model_scale(make_pairs(0.5, 0.01, 0, 1)).is_ok());
  const std::vector<DepthPair> pairs(500, {0, 0.0, 1.0});  // no depth in the model
  EXPECT_FALSE(estimate_model_scale(pairs).is_ok());
}

}  // namespace
}  // namespace camloc::mapping
