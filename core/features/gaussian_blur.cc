// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/gaussian_blur.h"

#include <cassert>
#include <cmath>
#include <cstring>

namespace camloc {
namespace {

constexpr int kRadius = 3;
/// exp(-x^2 / (2 sigma^2)) with sigma 2 for x = 0..3, normalized.
constexpr float kWeights[4] = {0.21610594100794114F, 0.19071282356963737F, 0.131074878967366F, 0.07015932695902607F};

/// Weighted sum of the centre and of the three pairs beside it. One order of operations for all kernels.
float weighted(float centre, float pair1, float pair2, float pair3) {
  return (centre * kWeights[0] + pair1 * kWeights[1]) + (pair2 * kWeights[2] + pair3 * kWeights[3]);
}

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

void GaussianBlur::blur_row(const PaddedImage& src, int y, float* out) {
  const std::uint8_t* row = src.row(y);
  for (int i = 1; i <= kRadius; ++i) {
    mirrored_[static_cast<std::size_t>(kRadius - i)] = row[mirrored_index(-i, src.width)];
    mirrored_[static_cast<std::size_t>(kRadius + src.width - 1 + i)] = row[mirrored_index(src.width - 1 + i, src.width)];
  }
  std::memcpy(mirrored_.data() + kRadius, row, static_cast<std::size_t>(src.width));
  const std::uint8_t* p = mirrored_.data();
  for (int x = 0; x < src.width; ++x)
    out[x] = weighted(p[x + 3], static_cast<float>(p[x + 2] + p[x + 4]), static_cast<float>(p[x + 1] + p[x + 5]),
                      static_cast<float>(p[x] + p[x + 6]));
}

void GaussianBlur::apply(const PaddedImage& src, int first_row, int last_row, PaddedImage* dst) {
  assert(src.width == dst->width && src.height == dst->height);
  const auto ring_row = [&](int y) { return ring_.data() + static_cast<std::size_t>((y + 8) & 7) * ring_stride_; };
  // Row y of the ring may lie outside the image (-3 .. height + 2); its pixels are those of the mirrored row.
  for (int y = first_row - kRadius; y < first_row + kRadius; ++y)
    blur_row(src, mirrored_index(y, src.height), ring_row(y));
  for (int y = first_row; y < last_row; ++y) {
    blur_row(src, mirrored_index(y + kRadius, src.height), ring_row(y + kRadius));
    const float* rows[7];
    for (int k = 0; k < 7; ++k) rows[k] = ring_row(y - kRadius + k);
    std::uint8_t* out = dst->row(y);
    for (int x = 0; x < src.width; ++x) {
      const float sum = weighted(rows[3][x], rows[2][x] + rows[4][x], rows[1][x] + rows[5][x], rows[0][x] + rows[6][x]);
      out[x] = static_cast<std::uint8_t>(std::lrint(sum));
    }
  }
}

}  // namespace camloc
