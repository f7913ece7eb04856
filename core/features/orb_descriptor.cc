// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/orb_descriptor.h"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include <array>
#include <bit>
#include <cfloat>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include "core/base/avx2.h"
#include "core/features/orb_pattern.h"

namespace camloc {
namespace {

constexpr int kRadius = 15;

/// Half width of each row of the disc, symmetric about the diagonal. Row v of a circle of radius 15, made so that (u, v)
/// is inside exactly when (v, u) is.
constexpr std::array<int, kRadius + 1> kHalfWidth = {15, 15, 15, 15, 14, 14, 14, 13, 13, 12, 11, 10, 9, 8, 6, 3};

float degrees_to_radians(float angle_deg) { return angle_deg * static_cast<float>(std::numbers::pi / 180.0); }

/// atan2 in degrees, [0, 360]: polynomial of degree 7, error below 0.3 degrees, the values of cv::fastAtan2.
float fast_atan2_deg(float y, float x) {
  constexpr auto kDegrees = static_cast<float>(180 / std::numbers::pi);
  constexpr float p1 = 0.9997878412794807F * kDegrees, p3 = -0.3258083974640975F * kDegrees;
  constexpr float p5 = 0.1555786518463281F * kDegrees, p7 = -0.04432655554792128F * kDegrees;
  constexpr auto kEpsilon = static_cast<float>(DBL_EPSILON);
  const float ax = std::abs(x), ay = std::abs(y);
  float angle = 0;
  if (ax >= ay) {
    const float c = ay / (ax + kEpsilon), c2 = c * c;
    angle = (((p7 * c2 + p5) * c2 + p3) * c2 + p1) * c;
  } else {
    const float c = ax / (ay + kEpsilon), c2 = c * c;
    angle = 90.F - (((p7 * c2 + p5) * c2 + p3) * c2 + p1) * c;
  }
  if (x < 0) angle = 180.F - angle;
  if (y < 0) angle = 360.F - angle;
  return angle;
}

struct Moments {
  int x = 0, y = 0;
};

Moments moments_any(const std::uint8_t* centre, std::ptrdiff_t stride) {
  Moments moments;
  for (int v = -kRadius; v <= kRadius; ++v) {
    const std::uint8_t* row = centre + v * stride;
    const int half_width = kHalfWidth[static_cast<std::size_t>(std::abs(v))];
    int sum = 0;
    for (int u = -half_width; u <= half_width; ++u) {
      sum += row[u];
      moments.x += u * row[u];
    }
    moments.y += v * sum;
  }
  return moments;
}

#if defined(__x86_64__)
/// For each |v|: the column u of each of the 32 pixels from u = -15 on, and 1, where the pixel lies in the disc, else 0.
struct alignas(32) DiscTable {
  std::int8_t u[kRadius + 1][32], one[kRadius + 1][32];
};

constexpr DiscTable make_disc_table() {
  DiscTable table{};
  for (int v = 0; v <= kRadius; ++v)
    for (int u = -kHalfWidth[static_cast<std::size_t>(v)]; u <= kHalfWidth[static_cast<std::size_t>(v)]; ++u) {
      table.u[v][u + kRadius] = static_cast<std::int8_t>(u);
      table.one[v][u + kRadius] = 1;
    }
  return table;
}

constexpr DiscTable kDisc = make_disc_table();

CAMLOC_AVX2 int sum_of_lanes(__m256i lanes) {
  const __m128i four = _mm_add_epi32(_mm256_castsi256_si128(lanes), _mm256_extracti128_si256(lanes, 1));
  const __m128i two = _mm_add_epi32(four, _mm_shuffle_epi32(four, 0x4e));
  return _mm_cvtsi128_si32(_mm_add_epi32(two, _mm_shuffle_epi32(two, 0xb1)));
}

CAMLOC_AVX2 CAMLOC_INLINE __m256i load(const void* p) { return _mm256_loadu_si256(static_cast<const __m256i*>(p)); }

CAMLOC_AVX2 Moments moments_avx2(const std::uint8_t* centre, std::ptrdiff_t stride) {
  const std::uint8_t* left = centre - kRadius;
  const __m256i ones = _mm256_set1_epi16(1);
  __m256i sum_x = _mm256_madd_epi16(_mm256_maddubs_epi16(load(left), load(kDisc.u[0])), ones);
  __m256i sum_y = _mm256_setzero_si256();
  for (int v = 1; v <= kRadius; ++v) {
    const __m256i below = load(left + v * stride), above = load(left - v * stride);
    const __m256i u = load(kDisc.u[v]), one = load(kDisc.one[v]);
    // Two neighbouring products of one row are at most 255 * 29, of two rows 14790: no 16-bit sum overflows.
    const __m256i x = _mm256_add_epi16(_mm256_maddubs_epi16(below, u), _mm256_maddubs_epi16(above, u));
    const __m256i y = _mm256_sub_epi16(_mm256_maddubs_epi16(below, one), _mm256_maddubs_epi16(above, one));
    sum_x = _mm256_add_epi32(sum_x, _mm256_madd_epi16(x, ones));
    sum_y = _mm256_add_epi32(sum_y, _mm256_madd_epi16(y, _mm256_set1_epi16(static_cast<short>(v))));
  }
  return {sum_of_lanes(sum_x), sum_of_lanes(sum_y)};
}
#endif

/// The pattern as arrays: the first points of the 256 tests, then the second points.
struct alignas(64) PatternArrays {
  float x[512], y[512];
};

constexpr PatternArrays make_pattern_arrays() {
  PatternArrays arrays{};
  for (std::size_t i = 0; i < kOrbPattern.size(); ++i) {
    const OrbTest& test = kOrbPattern[i];
    arrays.x[i] = test.x0, arrays.y[i] = test.y0;
    arrays.x[256 + i] = test.x1, arrays.y[256 + i] = test.y1;
  }
  return arrays;
}

constexpr PatternArrays kPattern = make_pattern_arrays();

/// Offset in the image of each end of each test, turned. Coordinates are rounded half to even: adding 1.5 * 2^23 leaves the
/// integer in the low bits.
CAMLOC_INLINE void turned_offsets(float c, float s, std::int32_t stride, std::int32_t* __restrict offsets) {
  const float* __restrict x = kPattern.x, * __restrict y = kPattern.y;
  constexpr float kMagic = 12582912.F;
  constexpr auto kMagicBits = std::bit_cast<std::int32_t>(kMagic);
  for (int i = 0; i < 512; ++i) {
    const std::int32_t column = std::bit_cast<std::int32_t>((x[i] * c - y[i] * s) + kMagic) - kMagicBits;
    const std::int32_t row = std::bit_cast<std::int32_t>((x[i] * s + y[i] * c) + kMagic) - kMagicBits;
    offsets[i] = row * stride + column;
  }
}

/// Fetches the 512 pixels and packs the 256 comparisons.
CAMLOC_INLINE Descriptor compare(const std::uint8_t* centre, const std::int32_t* offsets) {
  Descriptor descriptor;
  for (std::size_t word = 0; word < 4; ++word) {
    const std::int32_t *first = offsets + 64 * word, *second = first + 256;
    std::uint64_t bits = 0;
    for (int i = 0; i < 64; ++i) bits |= std::uint64_t{centre[first[i]] < centre[second[i]]} << i;
    descriptor.bits[word] = bits;
  }
  return descriptor;
}

// The same loop compiled for the baseline and for AVX2; the compiler vectorizes it.
void offsets_any(float c, float s, std::int32_t stride, std::int32_t* offsets) { turned_offsets(c, s, stride, offsets); }
CAMLOC_AVX2 void offsets_avx2(float c, float s, std::int32_t stride, std::int32_t* offsets) { turned_offsets(c, s, stride, offsets); }

}  // namespace

float orb_orientation_deg(const std::uint8_t* centre, std::ptrdiff_t stride) {
#if defined(__x86_64__)
  static const auto moments_of = has_avx2() ? moments_avx2 : moments_any;
  const Moments moments = moments_of(centre, stride);
#else
  const Moments moments = moments_any(centre, stride);
#endif
  return fast_atan2_deg(static_cast<float>(moments.y), static_cast<float>(moments.x));
}

float orb_angle_rad(float angle_deg) {
  const float angle_rad = degrees_to_radians(angle_deg);
  return angle_rad < static_cast<float>(2 * std::numbers::pi) ? angle_rad : 0.F;
}

Descriptor orb_descriptor(const std::uint8_t* centre, std::ptrdiff_t stride, float angle_deg) {
  static const auto turned = has_avx2() ? offsets_avx2 : offsets_any;
  const float angle_rad = degrees_to_radians(angle_deg);
  alignas(64) std::int32_t offsets[512];
  turned(std::cos(angle_rad), std::sin(angle_rad), static_cast<std::int32_t>(stride), offsets);
  return compare(centre, offsets);
}

}  // namespace camloc
