// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Bayer mosaics: around a pixel there are four sums: itself, its two neighbours in the row, its two in the column, its four on the
// diagonals. Which colour each of them is depends on the parities of x and y alone.
#include "drivers/raw_pixels.h"

#include <array>
#include <cassert>

namespace camloc {

namespace {

/// Pixels that a step of the inner loop takes, for compilers to put into vectors. Even, so that every step starts alike.
constexpr int kBlock = 16;

/// 256ths of a grey level per pixel of each sum.
struct GrayTaps {
  std::uint16_t centre, horizontal, vertical, diagonal;
};
constexpr GrayTaps kRed{76, 38, 38, 7};
constexpr GrayTaps kGreenInRedRow{152, 38, 14, 0};
constexpr GrayTaps kGreenInBlueRow{152, 14, 38, 0};
constexpr GrayTaps kBlue{28, 38, 38, 19};

struct BlockTaps {
  std::array<std::uint16_t, kBlock> centre, horizontal, vertical, diagonal;
};

bool is_red_column(BayerOrder order, int x) { return ((x & 1) == 0) == (order == BayerOrder::kRggb || order == BayerOrder::kGbrg); }
bool is_red_row(BayerOrder order, int y) { return ((y & 1) == 0) == (order == BayerOrder::kRggb || order == BayerOrder::kGrbg); }

GrayTaps taps_at(bool in_red_column, bool in_red_row) {
  if (in_red_row) return in_red_column ? kRed : kGreenInRedRow;
  return in_red_column ? kGreenInBlueRow : kBlue;
}

/// Three rows of the mosaic, the outer ones mirrored at the border.
struct Rows {
  const std::uint8_t* above;
  const std::uint8_t* centre;
  const std::uint8_t* below;
};

Rows rows_at(const ImageView<std::uint8_t>& mosaic, int y) {
  const int above = y > 0 ? y - 1 : 1, below = y + 1 < mosaic.height ? y + 1 : y - 1;
  return {mosaic.row(above), mosaic.row(y), mosaic.row(below)};
}

struct Sums {
  unsigned centre, horizontal, vertical, diagonal;
};

Sums sums_at(const Rows& rows, int x, int width) {
  const int left = x > 0 ? x - 1 : 1, right = x + 1 < width ? x + 1 : x - 1;
  return {rows.centre[x], static_cast<unsigned>(rows.centre[left] + rows.centre[right]),
          static_cast<unsigned>(rows.above[x] + rows.below[x]),
          static_cast<unsigned>(rows.above[left] + rows.above[right] + rows.below[left] + rows.below[right])};
}

std::uint8_t gray_at(const Rows& rows, int x, int width, const GrayTaps& taps) {
  const Sums s = sums_at(rows, x, width);
  const unsigned gray = taps.centre * s.centre + taps.horizontal * s.horizontal + taps.vertical * s.vertical + taps.diagonal * s.diagonal;
  return static_cast<std::uint8_t>((gray + 128) >> 8);
}

// kBlock pixels from `x`, none of them at the border. The weights add up to 256, so 16 bits hold every sum.
void gray_block(const Rows& rows, int x, const BlockTaps& taps, std::uint8_t* gray) {
  const std::uint8_t *n = rows.above + x, *c = rows.centre + x, *s = rows.below + x;
  for (int i = 0; i < kBlock; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const auto horizontal = static_cast<std::uint16_t>(c[i - 1] + c[i + 1]);
    const auto vertical = static_cast<std::uint16_t>(n[i] + s[i]);
    const auto diagonal = static_cast<std::uint16_t>(n[i - 1] + n[i + 1] + s[i - 1] + s[i + 1]);
    const auto sum = static_cast<std::uint16_t>(taps.centre[at] * c[i] + taps.horizontal[at] * horizontal + taps.vertical[at] * vertical +
                                                taps.diagonal[at] * diagonal + 128);
    gray[x + i] = static_cast<std::uint8_t>(sum >> 8);
  }
}

BlockTaps block_taps(const std::array<GrayTaps, 2>& taps_of_parity, int first_x) {
  BlockTaps block{};
  for (std::size_t i = 0; i < kBlock; ++i) {
    const GrayTaps& taps = taps_of_parity[(i + static_cast<std::size_t>(first_x)) & 1];
    block.centre[i] = taps.centre;
    block.horizontal[i] = taps.horizontal;
    block.vertical[i] = taps.vertical;
    block.diagonal[i] = taps.diagonal;
  }
  return block;
}

/// Mean of `count` values of which `sum` is the sum.
std::uint8_t mean(unsigned sum, unsigned count) { return static_cast<std::uint8_t>((sum + count / 2) / count); }

Bgr color_of(const Sums& s, bool in_red_column, bool in_red_row) {
  const auto own = static_cast<std::uint8_t>(s.centre);
  if (in_red_column != in_red_row) {
    const std::uint8_t horizontal = mean(s.horizontal, 2), vertical = mean(s.vertical, 2);
    return in_red_row ? Bgr{vertical, own, horizontal} : Bgr{horizontal, own, vertical};
  }
  const std::uint8_t green = mean(s.horizontal + s.vertical, 4), other = mean(s.diagonal, 4);
  return in_red_row ? Bgr{other, green, own} : Bgr{own, green, other};
}

// ---- packed pixels

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

void bayer_to_gray(const ImageView<std::uint8_t>& mosaic, BayerOrder order, Image<std::uint8_t>* gray) {
  assert(mosaic.width >= 2 && mosaic.height >= 2);
  const int width = mosaic.width;
  gray->resize(width, mosaic.height);
  for (int y = 0; y < mosaic.height; ++y) {
    const Rows rows = rows_at(mosaic, y);
    std::uint8_t* out = gray->row(y);
    const bool in_red_row = is_red_row(order, y);
    const std::array<GrayTaps, 2> taps{taps_at(is_red_column(order, 0), in_red_row), taps_at(is_red_column(order, 1), in_red_row)};
    const BlockTaps block = block_taps(taps, 1);
    int x = 1;
    out[0] = gray_at(rows, 0, width, taps[0]);
    for (; x + kBlock < width; x += kBlock) gray_block(rows, x, block, out);
    for (; x < width; ++x) out[x] = gray_at(rows, x, width, taps[x & 1]);
  }
}

void bayer_to_bgr(const ImageView<std::uint8_t>& mosaic, BayerOrder order, Image<Bgr>* color) {
  assert(mosaic.width >= 2 && mosaic.height >= 2);
  color->resize(mosaic.width, mosaic.height);
  for (int y = 0; y < mosaic.height; ++y) {
    const Rows rows = rows_at(mosaic, y);
    const bool in_red_row = is_red_row(order, y);
    Bgr* out = color->row(y);
    for (int x = 0; x < mosaic.width; ++x) out[x] = color_of(sums_at(rows, x, mosaic.width), is_red_column(order, x), in_red_row);
  }
}

void unpack_pixels(const std::uint8_t* packed, std::size_t num_pixels, unsigned bits, std::uint16_t* pixels) {
  assert(bits >= 1 && bits <= 16);
  std::size_t done = 0;
  if (bits == 10) done = unpack_groups<10>(packed, num_pixels, pixels);
  if (bits == 11) done = unpack_groups<11>(packed, num_pixels, pixels);
  for (; done < num_pixels; ++done) pixels[done] = unpack_one(packed, done, bits);
}

void rgb_to_bgr(std::span<const std::uint8_t> rgb, Image<Bgr>* color) {
  for (std::size_t i = 0; i < color->pixels.size(); ++i) color->pixels[i] = {rgb[3 * i + 2], rgb[3 * i + 1], rgb[3 * i]};
}

}  // namespace camloc
