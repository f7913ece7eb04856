// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// For x86-64, AVX2 scores 32 pixels at once without a branch per pixel; SSE2, which every x86-64 has, sorts out 16 pixels at once
// and leaves the few that may be corners to the portable code.
#include "core/features/fast_corners.h"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include <algorithm>
#include <bit>
#include <cstring>
#include <initializer_list>

#include "core/base/avx2.h"

namespace camloc {
namespace {

constexpr int kCircle[16][2] = {{0, 3},  {1, 3},   {2, 2},   {3, 1},   {3, 0},  {3, -1}, {2, -2}, {1, -3},
                                {0, -3}, {-1, -3}, {-2, -2}, {-3, -1}, {-3, 0}, {-3, 1}, {-2, 2}, {-1, 3}};

/// Largest over the 16 arcs of nine of the smallest difference in the arc.
int best_arc(const int (&difference)[16]) {
  int best = -256;
  for (int start = 0; start < 16; ++start) {
    int smallest = 256;
    for (int i = 0; i < 9; ++i) smallest = std::min(smallest, difference[(start + i) & 15]);
    best = std::max(best, smallest);
  }
  return best;
}

/// Offsets of the circle of radius 3 in order around it; pixel i + 8 is opposite of pixel i.
void circle_offsets(std::ptrdiff_t stride, std::ptrdiff_t* offset) {
  for (int i = 0; i < 16; ++i) offset[i] = kCircle[i][1] * stride + kCircle[i][0];
}

/// Score of one pixel, 0 if it is no corner at the threshold.
std::uint8_t score_of_pixel(const std::uint8_t* centre, const std::ptrdiff_t* offset, int threshold) {
  // Every arc of nine holds one end of each diameter.
  const int a = centre[offset[0]] - *centre, b = centre[offset[8]] - *centre;
  const int c = centre[offset[4]] - *centre, d = centre[offset[12]] - *centre;
  const bool may_be_brighter = std::max(a, b) > threshold && std::max(c, d) > threshold;
  const bool may_be_darker = std::min(a, b) < -threshold && std::min(c, d) < -threshold;
  if (!may_be_brighter && !may_be_darker) return 0;
  int brighter[16], darker[16];
  for (int i = 0; i < 16; ++i) {
    brighter[i] = centre[offset[i]] - *centre;
    darker[i] = -brighter[i];
  }
  const int best = std::max(best_arc(brighter), best_arc(darker));
  return best > threshold ? static_cast<std::uint8_t>(best - 1) : std::uint8_t{0};
}

void scores_scalar(const std::uint8_t* pixels, std::ptrdiff_t stride, int count, int threshold, std::uint8_t* scores) {
  std::ptrdiff_t offset[16];
  circle_offsets(stride, offset);
  for (int x = 0; x < count; ++x) scores[x] = score_of_pixel(pixels + x, offset, threshold);
}

#if defined(__x86_64__)
inline __m128i load16(const std::uint8_t* p) { return _mm_loadu_si128(reinterpret_cast<const __m128i*>(p)); }

/// Bit i is set when pixel i may be a corner: each of the two diameters has an end on the same side of the bounds.
inline unsigned may_be_corners(const std::uint8_t* centre, const std::ptrdiff_t* offset, __m128i threshold) {
  const __m128i c = load16(centre);
  const __m128i above = _mm_adds_epu8(c, threshold), below = _mm_subs_epu8(c, threshold);
  __m128i brighter = _mm_set1_epi8(-1), darker = _mm_setzero_si128();
  for (const int i : {0, 4, 2, 6}) {
    const __m128i a = load16(centre + offset[i]), b = load16(centre + offset[i + 8]);
    brighter = _mm_min_epu8(brighter, _mm_max_epu8(a, b));
    darker = _mm_max_epu8(darker, _mm_min_epu8(a, b));
  }
  const __m128i excess = _mm_or_si128(_mm_subs_epu8(brighter, above), _mm_subs_epu8(below, darker));
  return static_cast<unsigned>(_mm_movemask_epi8(_mm_cmpeq_epi8(excess, _mm_setzero_si128()))) ^ 0xffffU;
}

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
  for (const int first : {0, 2}) {
    for (const int i : {first, first + 4}) {
      const __m256i a = load32(centre + offset[i]), b = load32(centre + offset[i + 8]);
      brighter = _mm256_min_epu8(brighter, _mm256_max_epu8(a, b));
      darker = _mm256_max_epu8(darker, _mm256_min_epu8(a, b));
    }
    const __m256i excess = _mm256_or_si256(_mm256_subs_epu8(brighter, above), _mm256_subs_epu8(below, darker));
    if (_mm256_testz_si256(excess, excess)) return zero;
  }
  return scores_of_32(centre, offset, c, threshold);
}

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
#endif

}  // namespace

std::vector<FastKernel> available_fast_kernels() {
  std::vector<FastKernel> kernels{{"scalar", scores_scalar}};
#if defined(__x86_64__)
  kernels.push_back({"sse2", scores_sse2});
  if (has_avx2()) kernels.push_back({"avx2", scores_avx2});
#endif
  return kernels;
}

}  // namespace camloc
