// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// See packed_pixels.h.
#include "drivers/packed_pixels.h"

#include <cassert>

namespace camloc {

namespace {

constexpr std::size_t kGroup = 8;  // pixels; whatever their width, as many bytes as a pixel has bits

std::uint64_t big_endian_word(const std::uint8_t* bytes) {
  std::uint64_t word = 0;
  for (int i = 0; i < 8; ++i) word = word << 8 | bytes[i];  // compilers know this as one load
  return word;
}

// A group of eight pixels starts and ends at whole bytes: four pixels in its first eight bytes, four in its last eight.
template <unsigned kBits>
void unpack_group(const std::uint8_t* packed, std::uint16_t* pixels) {
  static_assert(kBits >= 8 && kBits <= 16);
  constexpr std::uint64_t kMask = (1U << kBits) - 1;
  const std::uint64_t first = big_endian_word(packed), last = big_endian_word(packed + kBits - 8);
  for (unsigned i = 0; i < 4; ++i) {
    pixels[i] = static_cast<std::uint16_t>(first >> (64 - (i + 1) * kBits) & kMask);
    pixels[4 + i] = static_cast<std::uint16_t>(last >> (3 - i) * kBits & kMask);
  }
}

std::uint16_t unpack_one(const std::uint8_t* packed, std::size_t index, unsigned bits) {
  std::uint32_t value = 0;
  for (std::size_t bit = index * bits; bit < (index + 1) * bits; ++bit) value = value << 1 | (packed[bit / 8] >> (7 - bit % 8) & 1U);
  return static_cast<std::uint16_t>(value);
}

template <unsigned kBits>
std::size_t unpack_groups(const std::uint8_t* packed, std::size_t num_pixels, std::uint16_t* pixels) {
  std::size_t done = 0;
  for (; done + kGroup <= num_pixels; done += kGroup) unpack_group<kBits>(packed + done / kGroup * kBits, pixels + done);
  return done;
}

}  // namespace

void unpack_pixels(const std::uint8_t* packed, std::size_t num_pixels, unsigned bits, std::uint16_t* pixels) {
  assert(bits >= 1 && bits <= 16);
  std::size_t done = 0;
  if (bits == 10) done = unpack_groups<10>(packed, num_pixels, pixels);
  if (bits == 11) done = unpack_groups<11>(packed, num_pixels, pixels);
  for (; done < num_pixels; ++done) pixels[done] = unpack_one(packed, done, bits);
}

}  // namespace camloc
