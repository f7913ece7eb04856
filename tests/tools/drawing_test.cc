// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Lines, dots and letters are where they should be, as wide as they should be, and nowhere else.
#include "tools/common/drawing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

namespace camloc::tools {
namespace {

constexpr Rgb kBlack{0, 0, 0}, kWhite{255, 255, 255}, kRed{255, 0, 0};

int red_at(const ColorImage& image, int u, int v) { return image.pixels[static_cast<std::size_t>(3 * (v * image.width + u))]; }

/// How much of the picture is covered, in pixels.
double ink(const ColorImage& image) {
  double sum = 0;
  for (std::size_t i = 0; i < image.pixels.size(); i += 3) sum += image.pixels[i] / 255.0;
  return sum;
}

TEST(Drawing, ALineIsAsWideAsItSaysInEveryDirection) {
  for (const double width : {1.0, 2.0, 5.0}) {
    for (double angle = 0; angle < 3.1; angle += 0.37) {
      ColorImage image = blank_image(200, 200, kBlack);
      const Eigen::Vector2d half = 80 * Eigen::Vector2d(std::cos(angle), std::sin(angle)), middle(99.3, 100.8);
      draw_line(&image, middle - half, middle + half, kRed, width);
      const double area = 160 * width + M_PI * width * width / 4;  // with its round ends
      EXPECT_NEAR(ink(image), area, 0.03 * area + 1) << width << " px at " << angle;
    }
  }
}

TEST(Drawing, ALineOnAPixelRowIsSharp) {
  ColorImage image = blank_image(50, 20, kWhite);
  draw_line(&image, {10, 7}, {40, 7}, kBlack, 1);
  EXPECT_EQ(red_at(image, 25, 7), 0);
  EXPECT_EQ(red_at(image, 25, 6), 255);
  EXPECT_EQ(red_at(image, 25, 8), 255);
  EXPECT_EQ(red_at(image, 43, 7), 255);
}

TEST(Drawing, ADiscHasItsArea) {
  ColorImage image = blank_image(50, 50, kBlack);
  draw_disc(&image, {20.4, 25.7}, 6, kRed);
  EXPECT_NEAR(ink(image), M_PI * 36, 1.5);
  EXPECT_EQ(red_at(image, 20, 26), 255);
}

TEST(Drawing, WhatIsOutsideIsCutOffAndWhatIsNotFiniteIsNotDrawn) {
  ColorImage image = blank_image(30, 20, kBlack);
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinite = std::numeric_limits<double>::infinity();
  draw_line(&image, {nan, 0}, {10, 10}, kRed, 2);
  draw_line(&image, {0, 0}, {infinite, 10}, kRed, 2);
  draw_line(&image, {-5, -5}, {-1e9, 40}, kRed, 2);
  draw_disc(&image, {1e300, -1e300}, 3, kRed);
  draw_rectangle(&image, -10, 5, 10, 5, kRed);
  draw_rectangle(&image, 5, 5, -3, 4, kRed);
  draw_text(&image, -500, 2000, "outside", 12, kRed);
  EXPECT_EQ(ink(image), 0);
  draw_line(&image, {-1e6, 10}, {1e6, 10}, kRed, 1);
  EXPECT_EQ(ink(image), 30);
  draw_rectangle(&image, 28, 18, 100, 100, kRed);
  EXPECT_EQ(ink(image), 34);
}

TEST(Drawing, EveryLetterIsAShapeOfItsOwnInsideOfItsWidth) {
  std::set<std::vector<std::uint8_t>> shapes;
  for (char c = '!'; c <= '~'; ++c) {
    ColorImage image = blank_image(60, 60, kBlack);
    const int width = text_width(std::string(1, c), 24);
    draw_text(&image, 10, 40, std::string(1, c), 24, kRed);
    EXPECT_TRUE(shapes.insert(image.pixels).second) << c << " looks like another letter";
    EXPECT_GT(ink(image), 3) << c;
    for (int v = 0; v < image.height; ++v) {
      for (int u = 0; u < image.width; ++u) {
        if (red_at(image, u, v) == 0) continue;
        EXPECT_TRUE(u >= 8 && u <= 10 + width && v >= 10 && v <= 50) << c << " at " << u << ", " << v;
      }
    }
  }
}

TEST(Drawing, CapitalsStandOnTheLineAndAreAsHighAsTheySay) {
  ColorImage image = blank_image(60, 60, kBlack);
  draw_text(&image, 10, 40, "I", 24, kRed);
  EXPECT_GT(red_at(image, 11, 17), 128);
  EXPECT_EQ(red_at(image, 11, 13), 0);
  EXPECT_GT(red_at(image, 11, 39), 128);
  EXPECT_EQ(red_at(image, 11, 43), 0);
}

TEST(Drawing, WhatIsNotAsciiIsAQuestionMark) {
  ColorImage image = blank_image(60, 40, kBlack), question = image;
  draw_text(&image, 5, 30, "\xc3\n", 12, kRed);
  draw_text(&question, 5, 30, "??", 12, kRed);
  EXPECT_EQ(image.pixels, question.pixels);
  EXPECT_EQ(text_width("a\xff", 12), text_width("a?", 12));
  EXPECT_EQ(text_width("", 12), 0);
}

}  // namespace
}  // namespace camloc::tools
