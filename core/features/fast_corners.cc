// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/fast_corners.h"

#include <algorithm>

#include "core/features/fast_corners_kernels.h"

namespace camloc {
namespace fast {
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

void scores_scalar(const std::uint8_t* pixels, std::ptrdiff_t stride, int count, int threshold, std::uint8_t* scores) {
  std::ptrdiff_t offset[16];
  circle_offsets(stride, offset);
  for (int x = 0; x < count; ++x) scores[x] = score_of_pixel(pixels + x, offset, threshold);
}

}  // namespace

void circle_offsets(std::ptrdiff_t stride, std::ptrdiff_t* offset) {
  for (int i = 0; i < 16; ++i) offset[i] = kCircle[i][1] * stride + kCircle[i][0];
}

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

}  // namespace fast

const char* to_string(FastKernel kernel) {
  switch (kernel) {
    case FastKernel::kScalar: return "scalar";
    case FastKernel::kSse2: return "sse2";
    case FastKernel::kAvx2: return "avx2";
  }
  return "unknown";
}

std::vector<FastKernel> available_fast_kernels() {
  std::vector<FastKernel> kernels{FastKernel::kScalar};
#if defined(__x86_64__)
  kernels.push_back(FastKernel::kSse2);
  if (__builtin_cpu_supports("avx2")) kernels.push_back(FastKernel::kAvx2);
#endif
  return kernels;
}

FastKernel best_fast_kernel() { return available_fast_kernels().back(); }

FastScoresFunction fast_scores_function(FastKernel kernel) {
  switch (kernel) {
#if defined(__x86_64__)
    case FastKernel::kSse2: return fast::scores_sse2;
    case FastKernel::kAvx2: return fast::scores_avx2;
#endif
    default: return fast::scores_scalar;
  }
}

}  // namespace camloc
