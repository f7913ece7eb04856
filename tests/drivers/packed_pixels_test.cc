// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "drivers/raw_pixels.h"

namespace camloc {
namespace {

TEST(PackedPixels, UnpackWhatWasPackedBitByBit) {
  std::mt19937 random(3);
  for (const unsigned bits : {1U, 7U, 8U, 10U, 11U, 12U, 16U}) {
    for (const std::size_t count :
         {std::size_t{0}, std::size_t{1}, std::size_t{7}, std::size_t{8}, std::size_t{9}, std::size_t{101}, std::size_t{640}}) {
      std::vector<std::uint16_t> pixels(count);
      std::vector<std::uint8_t> packed(packed_bytes(count, bits));
      for (std::size_t i = 0; i < count; ++i) {
        pixels[i] = static_cast<std::uint16_t>(random() & ((1U << bits) - 1));
        for (std::size_t bit = 0; bit < bits; ++bit) {
          const std::size_t at = i * bits + bit;
          if ((pixels[i] >> (bits - 1 - bit) & 1) != 0) packed[at / 8] = static_cast<std::uint8_t>(packed[at / 8] | 0x80U >> at % 8);
        }
      }
      std::vector<std::uint16_t> unpacked(count);
      unpack_pixels(packed.data(), count, bits, unpacked.data());
      EXPECT_EQ(unpacked, pixels) << bits << " bits, " << count;
    }
  }
}

TEST(PackedPixels, FirstPixelIsInTheHighestBits) {
  const std::uint8_t packed[] = {0xFF, 0xE0, 0x04};  // 11111111 111 00000 00000100: 2047, then 0b00000000001 and two bits
  std::uint16_t pixels[2] = {};
  unpack_pixels(packed, 2, 11, pixels);
  EXPECT_EQ(pixels[0], 2047);
  EXPECT_EQ(pixels[1], 1);
}

}  // namespace
}  // namespace camloc
