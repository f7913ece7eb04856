// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// FAST-9/16 corner scores (Rosten, Drummond, "Machine learning for high-speed corner detection", 2006). A pixel is a
// corner at threshold t when nine neighbouring pixels of the circle of radius 3 are all brighter than it by more than t
// or all darker; its score is the largest t at which that holds, as in OpenCV.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace camloc {

/// Scores of `count` pixels from `pixels` on: scores[i] is the score of pixels[i] if it is a corner at `threshold` (>= 1),
/// else 0. Reads three pixels around and up to 35 pixels past the last one in each of the seven rows; writes count scores
/// and nothing else. All kernels give the same scores.
using FastScoresFunction = void (*)(const std::uint8_t* pixels, std::ptrdiff_t stride, int count, int threshold, std::uint8_t* scores);

struct FastKernel {
  const char* name;
  FastScoresFunction scores;
};

/// Kernels this processor can run, slowest first.
[[nodiscard]] std::vector<FastKernel> available_fast_kernels();

}  // namespace camloc
