// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// FAST corner scores for x86-64. AVX2 scores 32 pixels at once without a branch per pixel; SSE2, which every x86-64 has,
// sorts out 16 pixels at once and leaves the few that may be corners to the portable code.
#if defined(__x86_64__)
#include <immintrin.h>

#include <bit>
#include <cstring>
#include <initializer_list>

#include "core/features/fast_corners_kernels.h"

namespace camloc::fast {
namespace {

/// Ends of a diameter against the centre, for 16 pixels: not zero where one of them is brighter (darker) by more than t.
struct Sse2Bounds {
  __m128i above;  ///< centre + t, saturated
  __m128i below;  ///< centre - t, saturated
};

inline __m128i load16(const std::uint8_t* p) { return _mm_loadu_si128(reinterpret_cast<const __m128i*>(p)); }

/// Bit i is set when pixel i may be a corner: each of the two diameters has an end on the same side of the bounds.
inline unsigned may_be_corners(const std::uint8_t* centre, const std::ptrdiff_t* offset, __m128i threshold) {
  const __m128i c = load16(centre);
  const Sse2Bounds bounds{_mm_adds_epu8(c, threshold), _mm_subs_epu8(c, threshold)};
  __m128i brighter = _mm_set1_epi8(-1), darker = _mm_setzero_si128();
  for (const int i : {0, 4, 2, 6}) {
    const __m128i a = load16(centre + offset[i]), b = load16(centre + offset[i + 8]);
    brighter = _mm_min_epu8(brighter, _mm_max_epu8(a, b));
    darker = _mm_max_epu8(darker, _mm_min_epu8(a, b));
  }
  const __m128i excess = _mm_or_si128(_mm_subs_epu8(brighter, bounds.above), _mm_subs_epu8(bounds.below, darker));
  return static_cast<unsigned>(_mm_movemask_epi8(_mm_cmpeq_epi8(excess, _mm_setzero_si128()))) ^ 0xffffU;
}

#define CAMLOC_AVX2 __attribute__((target("avx2")))

CAMLOC_AVX2 inline __m256i load32(const std::uint8_t* p) { return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(p)); }

/// Score of 32 pixels, 0 where they are no corners. Two arcs of nine that start one apart share eight pixels, whose
/// minimum S serves both: max(min(S, first), min(S, last)) = min(S, max(first, last)).
CAMLOC_AVX2 inline __m256i scores_of_32(const std::uint8_t* centre, const std::ptrdiff_t* offset, __m256i c, __m256i threshold) {
  __m256i p[16], low2[8], high2[8], low4[8], high4[8];
  for (int i = 0; i < 16; ++i) p[i] = load32(centre + offset[i]);
  for (int i = 0; i < 8; ++i) {
    low2[i] = _mm256_min_epu8(p[2 * i + 1], p[(2 * i + 2) & 15]);
    high2[i] = _mm256_max_epu8(p[2 * i + 1], p[(2 * i + 2) & 15]);
  }
  for (int i = 0; i < 8; ++i) {
    low4[i] = _mm256_min_epu8(low2[i], low2[(i + 1) & 7]);
    high4[i] = _mm256_max_epu8(high2[i], high2[(i + 1) & 7]);
  }
  __m256i brightest = _mm256_setzero_si256(), darkest = _mm256_set1_epi8(-1);
  for (int i = 0; i < 8; ++i) {
    const __m256i low8 = _mm256_min_epu8(low4[i], low4[(i + 2) & 7]), high8 = _mm256_max_epu8(high4[i], high4[(i + 2) & 7]);
    const __m256i first = p[2 * i], last = p[(2 * i + 9) & 15];
    brightest = _mm256_max_epu8(brightest, _mm256_min_epu8(low8, _mm256_max_epu8(first, last)));
    darkest = _mm256_min_epu8(darkest, _mm256_max_epu8(high8, _mm256_min_epu8(first, last)));
  }
  const __m256i excess = _mm256_max_epu8(_mm256_subs_epu8(brightest, c), _mm256_subs_epu8(c, darkest));
  const __m256i is_none = _mm256_cmpeq_epi8(_mm256_subs_epu8(excess, threshold), _mm256_setzero_si256());
  return _mm256_andnot_si256(is_none, _mm256_sub_epi8(excess, _mm256_set1_epi8(1)));
}

/// The quick test on four diameters, then all sixteen pixels if any of the 32 passed.
CAMLOC_AVX2 inline __m256i block_of_32(const std::uint8_t* centre, const std::ptrdiff_t* offset, __m256i threshold) {
  const __m256i c = load32(centre), zero = _mm256_setzero_si256();
  const __m256i above = _mm256_adds_epu8(c, threshold), below = _mm256_subs_epu8(c, threshold);
  __m256i brighter = _mm256_set1_epi8(-1), darker = zero;
  for (const int i : {0, 4}) {
    const __m256i a = load32(centre + offset[i]), b = load32(centre + offset[i + 8]);
    brighter = _mm256_min_epu8(brighter, _mm256_max_epu8(a, b));
    darker = _mm256_max_epu8(darker, _mm256_min_epu8(a, b));
  }
  const __m256i first = _mm256_or_si256(_mm256_subs_epu8(brighter, above), _mm256_subs_epu8(below, darker));
  if (_mm256_testz_si256(first, first)) return zero;
  for (const int i : {2, 6}) {
    const __m256i a = load32(centre + offset[i]), b = load32(centre + offset[i + 8]);
    brighter = _mm256_min_epu8(brighter, _mm256_max_epu8(a, b));
    darker = _mm256_max_epu8(darker, _mm256_min_epu8(a, b));
  }
  const __m256i second = _mm256_or_si256(_mm256_subs_epu8(brighter, above), _mm256_subs_epu8(below, darker));
  if (_mm256_testz_si256(second, second)) return zero;
  return scores_of_32(centre, offset, c, threshold);
}

}  // namespace

void scores_sse2(const std::uint8_t* pixels, std::ptrdiff_t stride, int count, int threshold, std::uint8_t* scores) {
  std::ptrdiff_t offset[16];
  circle_offsets(stride, offset);
  const __m128i wide_threshold = _mm_set1_epi8(static_cast<char>(threshold));
  std::memset(scores, 0, static_cast<std::size_t>(count));
  for (int x = 0; x < count; x += 16) {
    unsigned candidates = may_be_corners(pixels + x, offset, wide_threshold);
    if (count - x < 16) candidates &= (1U << (count - x)) - 1;
    for (; candidates != 0; candidates &= candidates - 1) {
      const int i = x + std::countr_zero(candidates);
      scores[i] = score_of_pixel(pixels + i, offset, threshold);
    }
  }
}

CAMLOC_AVX2 void scores_avx2(const std::uint8_t* pixels, std::ptrdiff_t stride, int count, int threshold, std::uint8_t* scores) {
  std::ptrdiff_t offset[16];
  circle_offsets(stride, offset);
  const __m256i wide_threshold = _mm256_set1_epi8(static_cast<char>(threshold));
  int x = 0;
  for (; x + 32 <= count; x += 32)
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(scores + x), block_of_32(pixels + x, offset, wide_threshold));
  if (x < count) {
    alignas(32) std::uint8_t tail[32];
    _mm256_store_si256(reinterpret_cast<__m256i*>(tail), block_of_32(pixels + x, offset, wide_threshold));
    std::memcpy(scores + x, tail, static_cast<std::size_t>(count - x));
  }
}

#undef CAMLOC_AVX2

}  // namespace camloc::fast
#endif
