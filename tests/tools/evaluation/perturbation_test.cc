// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What --perturb does to an image, against the formulas written out.
#include <gtest/gtest.h>

#include <cmath>

#include "tools/evaluation/sequence_run.h"

namespace camloc::tools {
namespace {

Image<std::uint8_t> ramp() {
  Image<std::uint8_t> image;
  image.resize(256, 2);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = static_cast<std::uint8_t>(i % 256);
  return image;
}

Image<std::uint8_t> changed(const std::vector<std::string>& texts, std::uint64_t sequence = 0) {
  std::vector<Perturbation> perturbations;
  for (const std::string& text : texts) {
    const auto parsed = parse_perturbation(text);
    EXPECT_TRUE(parsed.is_ok()) << text;
    if (parsed) perturbations.push_back(*parsed);
  }
  Image<std::uint8_t> image = ramp();
  apply(perturbations, sequence, &image);
  return image;
}

TEST(PerturbationTest, TonesFollowTheirFormulas) {
  for (int v = 0; v < 256; v += 5) {
    const auto i = static_cast<std::size_t>(v);
    EXPECT_EQ(changed({"gamma=0.5"}).pixels[i], std::lround(255 * std::sqrt(v / 255.0)));
    EXPECT_EQ(changed({"exposure=0.4"}).pixels[i], std::lround(0.4 * v));
    EXPECT_EQ(changed({"exposure=3"}).pixels[i], std::min(255, 3 * v));
    EXPECT_NEAR(changed({"contrast=0.6"}).pixels[i], 128 + 0.6 * (v - 128), 0.51);
  }
}

TEST(PerturbationTest, OrderMatters) {
  EXPECT_EQ(changed({"exposure=4", "exposure=0.25"}).pixels[200], 64);  // saturates first
  EXPECT_EQ(changed({"exposure=0.25", "exposure=4"}).pixels[200], 200);
}

TEST(PerturbationTest, NoiseHasItsSigmaAndDependsOnTheFrameOnly) {
  Image<std::uint8_t> gray;
  gray.resize(200, 200);
  std::fill(gray.pixels.begin(), gray.pixels.end(), std::uint8_t{128});
  auto again = gray, other = gray;
  apply({*parse_perturbation("noise=12")}, 5, &gray);
  apply({*parse_perturbation("noise=12")}, 5, &again);
  apply({*parse_perturbation("noise=12")}, 6, &other);
  EXPECT_EQ(gray.pixels, again.pixels);
  EXPECT_NE(gray.pixels, other.pixels);
  double sum = 0, sum_of_squares = 0;
  for (const std::uint8_t v : gray.pixels) {
    sum += v - 128.0;
    sum_of_squares += (v - 128.0) * (v - 128.0);
  }
  EXPECT_NEAR(sum / 40000, 0, 0.3);
  EXPECT_NEAR(std::sqrt(sum_of_squares / 40000), 12, 0.3);
}

TEST(PerturbationTest, BlurSpreadsAPointAlongItsRow) {
  Image<std::uint8_t> image;
  image.resize(31, 3);
  image.row(1)[15] = 90;
  apply({*parse_perturbation("blur=9")}, 0, &image);
  for (int x = 0; x < 31; ++x) {
    EXPECT_EQ(image.row(1)[x], std::abs(x - 15) <= 4 ? 10 : 0) << x;
    EXPECT_EQ(image.row(0)[x], 0);
  }
}

TEST(PerturbationTest, RefusesEverythingElse) {
  for (const char* text : {"", "=", "gamma", "gamma=", "gamma=x", "gamma=1x", "gamma=nan", "gamma=0", "gama=1", "noise=-1", "noise=129",
                           "blur=0", "blur=102"}) {
    const auto parsed = parse_perturbation(text);
    ASSERT_FALSE(parsed.is_ok()) << text;
    EXPECT_EQ(parsed.status().code(), ErrorCode::kInvalid);
    EXPECT_EQ(parsed.status().message().find(std::string("--perturb ") + text), 0U);
  }
}

}  // namespace
}  // namespace camloc::tools
