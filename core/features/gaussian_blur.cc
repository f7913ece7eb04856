// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/gaussian_blur.h"

#include <bit>
#include <cassert>
#include <cstring>

#include "core/base/avx2.h"

namespace camloc {
namespace {

constexpr int kRadius = 3;
/// exp(-x^2 / (2 sigma^2)) with sigma 2 for x = 0..3, normalized.
constexpr float kWeights[4] = {0.21610594100794114F, 0.19071282356963737F, 0.131074878967366F, 0.07015932695902607F};

/// Weighted sum of the centre and of the three pairs beside it. One order of operations for all kernels.
CAMLOC_INLINE float weighted(float centre, float pair1, float pair2, float pair3) {
  return (centre * kWeights[0] + pair1 * kWeights[1]) + (pair2 * kWeights[2] + pair3 * kWeights[3]);
}

/// `p` starts three pixels before the first of the row.
CAMLOC_INLINE void across_row(const std::uint8_t* __restrict p, int width, float* __restrict out) {
  for (int x = 0; x < width; ++x)
    out[x] = weighted(p[x + 3], static_cast<float>(p[x + 2] + p[x + 4]), static_cast<float>(p[x + 1] + p[x + 5]),
                      static_cast<float>(p[x] + p[x + 6]));
}

/// Rounds half to even: adding 1.5 * 2^23 leaves the integer in the low bits.
CAMLOC_INLINE void down_columns(const float* const* rows, int width, std::uint8_t* __restrict out) {
  const float* __restrict a = rows[0], * __restrict b = rows[1], * __restrict c = rows[2], * __restrict d = rows[3];
  const float* __restrict e = rows[4], * __restrict f = rows[5], * __restrict g = rows[6];
  for (int x = 0; x < width; ++x) {
    const float sum = weighted(d[x], c[x] + e[x], b[x] + f[x], a[x] + g[x]);
    out[x] = static_cast<std::uint8_t>(std::bit_cast<std::uint32_t>(sum + 12582912.F));
  }
}

// The same loops compiled for the baseline and for AVX2; the compiler vectorizes them.
void across_row_any(const std::uint8_t* p, int width, float* out) { across_row(p, width, out); }
void down_columns_any(const float* const* rows, int width, std::uint8_t* out) { down_columns(rows, width, out); }
CAMLOC_AVX2 void across_row_avx2(const std::uint8_t* p, int width, float* out) { across_row(p, width, out); }
CAMLOC_AVX2 void down_columns_avx2(const float* const* rows, int width, std::uint8_t* out) { down_columns(rows, width, out); }

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
  static const auto across = has_avx2() ? across_row_avx2 : across_row_any;
  across(mirrored_.data(), src.width, out);
}

void GaussianBlur::apply(const PaddedImage& src, PaddedImage* dst) {
  static const auto down = has_avx2() ? down_columns_avx2 : down_columns_any;
  assert(src.width == dst->width && src.height == dst->height);
  const auto ring_row = [&](int y) { return ring_.data() + static_cast<std::size_t>((y + 8) & 7) * ring_stride_; };
  // Row y of the ring may lie outside the image (-3 .. height + 2); its pixels are those of the mirrored row.
  for (int y = -kRadius; y < kRadius; ++y) blur_row(src, mirrored_index(y, src.height), ring_row(y));
  for (int y = 0; y < src.height; ++y) {
    blur_row(src, mirrored_index(y + kRadius, src.height), ring_row(y + kRadius));
    const float* rows[7];
    for (int k = 0; k < 7; ++k) rows[k] = ring_row(y - kRadius + k);
    down(rows, src.width, dst->row(y));
  }
}

}  // namespace camloc
