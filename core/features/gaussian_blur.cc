// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/gaussian_blur.h"

#include <algorithm>
#include <cassert>
#include <cstring>

namespace camloc {
namespace {

constexpr int kRadius = 3;
/// exp(-x^2 / (2 sigma^2)) with sigma 2 in 256ths, rounded with error diffusion so that the seven add up to 256.
constexpr std::uint32_t kWeights[7] = {18, 33, 49, 56, 49, 33, 18};

/// Index of the pixel that stands for index `i` of a row of n: ... 2 1 | 0 1 2 ... n-1 | n-2 ...
int mirrored_index(int i, int n) {
  if (n == 1) return 0;
  while (i < 0 || i >= n) i = i < 0 ? -i : 2 * (n - 1) - i;
  return i;
}

}  // namespace

GaussianBlur::GaussianBlur(int max_width)
    : mirrored_(static_cast<std::size_t>(max_width + 2 * kRadius + PaddedImage::kPadding)),
      ring_stride_(static_cast<std::size_t>(max_width + PaddedImage::kPadding)) {
  ring_.resize(8 * ring_stride_);
}

void GaussianBlur::blur_row(const PaddedImage& src, int y, std::uint16_t* out) {
  const std::uint8_t* row = src.row(y);
  for (int i = 1; i <= kRadius; ++i) {
    mirrored_[static_cast<std::size_t>(kRadius - i)] = row[mirrored_index(-i, src.width)];
    mirrored_[static_cast<std::size_t>(kRadius + src.width - 1 + i)] = row[mirrored_index(src.width - 1 + i, src.width)];
  }
  std::memcpy(mirrored_.data() + kRadius, row, static_cast<std::size_t>(src.width));
  const std::uint8_t* p = mirrored_.data();
  for (int x = 0; x < src.width; ++x)
    out[x] = static_cast<std::uint16_t>((p[x] + p[x + 6]) * kWeights[0] + (p[x + 1] + p[x + 5]) * kWeights[1] +
                                        (p[x + 2] + p[x + 4]) * kWeights[2] + p[x + 3] * kWeights[3]);
}

void GaussianBlur::apply(const PaddedImage& src, int first_row, int last_row, PaddedImage* dst) {
  assert(src.width == dst->width && src.height == dst->height);
  const auto ring_row = [&](int y) { return ring_.data() + static_cast<std::size_t>((y + 8) & 7) * ring_stride_; };
  // Row y of the ring may lie outside the image (-3 .. height + 2); its pixels are those of the mirrored row.
  for (int y = first_row - kRadius; y < first_row + kRadius; ++y)
    blur_row(src, mirrored_index(y, src.height), ring_row(y));
  for (int y = first_row; y < last_row; ++y) {
    blur_row(src, mirrored_index(y + kRadius, src.height), ring_row(y + kRadius));
    const std::uint16_t* rows[7];
    for (int k = 0; k < 7; ++k) rows[k] = ring_row(y - kRadius + k);
    std::uint8_t* out = dst->row(y);
    for (int x = 0; x < src.width; ++x) {
      std::uint32_t sum = 32768;
      for (int k = 0; k < 7; ++k) sum += rows[k][x] * kWeights[k];
      out[x] = static_cast<std::uint8_t>(sum >> 16);
    }
  }
}

}  // namespace camloc
