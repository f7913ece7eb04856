// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <string>

#include "drivers/raw_pixels.h"

namespace camloc {
namespace {

constexpr BayerOrder kOrders[] = {BayerOrder::kRggb, BayerOrder::kGrbg, BayerOrder::kGbrg, BayerOrder::kBggr};
constexpr std::array<std::string_view, 4> kPatterns{"RGGB", "GRBG", "GBRG", "BGGR"};

/// The colour letter of a mosaic's pixel; coordinates may be mirrored ones, -1 included.
char letter(BayerOrder order, int x, int y) {
  return kPatterns[static_cast<std::size_t>(order)][static_cast<std::size_t>(2 * (y & 1) + (x & 1))];
}

/// Mean of the pixels of one colour that are nearest to (x, y), straight from the definition.
double interpolated(const ImageView<std::uint8_t>& mosaic, BayerOrder order, int x, int y, char color) {
  if (letter(order, x, y) == color) return mosaic.at(x, y);
  double sum = 0, nearest = 10;
  int count = 0;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      if (letter(order, x + dx, y + dy) != color) continue;
      const double distance = std::hypot(dx, dy);
      if (distance > nearest + 0.1) continue;
      if (distance < nearest - 0.1) sum = count = 0, nearest = distance;
      const int u = x + dx < 0 ? 1 : x + dx >= mosaic.width ? mosaic.width - 2 : x + dx;
      const int v = y + dy < 0 ? 1 : y + dy >= mosaic.height ? mosaic.height - 2 : y + dy;
      sum += mosaic.at(u, v);
      ++count;
    }
  }
  return sum / count;
}

struct Mosaic {
  std::vector<std::uint8_t> bytes;
  ImageView<std::uint8_t> view;
};

Mosaic random_mosaic(int width, int height, int stride, unsigned seed) {
  std::mt19937 random(seed);
  Mosaic mosaic;
  mosaic.bytes.resize(static_cast<std::size_t>(stride * (height - 1) + width));  // not a byte behind the last pixel
  for (std::uint8_t& byte : mosaic.bytes) byte = static_cast<std::uint8_t>(random());
  mosaic.view = {mosaic.bytes.data(), width, height, stride};
  return mosaic;
}

TEST(Bayer, GrayIsTheLumaOfTheInterpolation) {
  for (const auto& [width, height] : {std::pair(2, 2), {3, 5}, {16, 2}, {17, 4}, {18, 3}, {33, 6}, {50, 9}}) {
    for (const BayerOrder order : kOrders) {
      const Mosaic mosaic = random_mosaic(width, height, width + 3, static_cast<unsigned>(width));
      Image<std::uint8_t> gray;
      bayer_to_gray(mosaic.view, order, &gray);
      ASSERT_EQ(gray.width, width);
      ASSERT_EQ(gray.height, height);
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
          const double luma = (19 * interpolated(mosaic.view, order, x, y, 'R') + 38 * interpolated(mosaic.view, order, x, y, 'G') +
                               7 * interpolated(mosaic.view, order, x, y, 'B')) /
                              64;
          ASSERT_EQ(gray.at(x, y), std::floor(luma + 0.5)) << x << ' ' << y << " of " << width << 'x' << height;
        }
      }
    }
  }
}

TEST(Bayer, ColorIsTheInterpolation) {
  for (const BayerOrder order : kOrders) {
    const Mosaic mosaic = random_mosaic(19, 7, 24, 5);
    Image<Bgr> color;
    bayer_to_bgr(mosaic.view, order, &color);
    for (int y = 0; y < 7; ++y) {
      for (int x = 0; x < 19; ++x) {
        EXPECT_EQ(color.at(x, y).r, std::floor(interpolated(mosaic.view, order, x, y, 'R') + 0.5));
        EXPECT_EQ(color.at(x, y).g, std::floor(interpolated(mosaic.view, order, x, y, 'G') + 0.5));
        EXPECT_EQ(color.at(x, y).b, std::floor(interpolated(mosaic.view, order, x, y, 'B') + 0.5));
      }
    }
  }
}

TEST(Bayer, APlainSurfaceHasOneGray) {
  for (const BayerOrder order : kOrders) {
    Mosaic mosaic = random_mosaic(40, 6, 40, 1);
    for (int y = 0; y < 6; ++y) {
      for (int x = 0; x < 40; ++x) {
        const char color = letter(order, x, y);
        mosaic.bytes[static_cast<std::size_t>(40 * y + x)] = color == 'R' ? 200 : color == 'G' ? 90 : 30;
      }
    }
    Image<std::uint8_t> gray;
    bayer_to_gray(mosaic.view, order, &gray);
    for (const std::uint8_t value : gray.pixels) EXPECT_EQ(value, (19 * 200 + 38 * 90 + 7 * 30 + 32) / 64);
  }
}

}  // namespace
}  // namespace camloc
