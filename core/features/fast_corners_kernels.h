// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Inside of fast_corners.cc: what the kernels share.
#pragma once

#include <cstddef>
#include <cstdint>

namespace camloc::fast {

/// Offsets of the circle of radius 3 in order around it; pixel i + 8 is opposite of pixel i.
void circle_offsets(std::ptrdiff_t stride, std::ptrdiff_t* offset);

/// Score of one pixel, 0 if it is no corner at the threshold.
std::uint8_t score_of_pixel(const std::uint8_t* centre, const std::ptrdiff_t* offset, int threshold);

#if defined(__x86_64__)
void scores_sse2(const std::uint8_t* pixels, std::ptrdiff_t stride, int count, int threshold, std::uint8_t* scores);
void scores_avx2(const std::uint8_t* pixels, std::ptrdiff_t stride, int count, int threshold, std::uint8_t* scores);
#endif

}  // namespace camloc::fast
