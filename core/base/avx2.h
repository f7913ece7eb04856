// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Loops that are written once and compiled twice, for the baseline and for AVX2: mark the second copy CAMLOC_AVX2, call it where
// has_avx2(). Vectors go between such functions by reference only: passing them by value would depend on the instruction set.
#pragma once

#if defined(__x86_64__)
#define CAMLOC_AVX2 __attribute__((target("avx2")))
#else
#define CAMLOC_AVX2
#endif
#define CAMLOC_INLINE inline __attribute__((always_inline))

namespace camloc {

[[nodiscard]] inline bool has_avx2() {
#if defined(__x86_64__)
  return __builtin_cpu_supports("avx2") != 0;
#else
  return false;
#endif
}

}  // namespace camloc
