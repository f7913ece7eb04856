// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The smoothing before rotated BRIEF: Gaussian 7 x 7, sigma 2, mirrored at the border without repeating the edge pixel.
// Bit for bit what cv::GaussianBlur gives for 8-bit images (weights of 8 fractional bits, one rounding at the end).
#pragma once

#include <cstdint>
#include <vector>

#include "core/features/image_pyramid.h"

namespace camloc {

/// Allocates at construction only. Not thread-safe.
class GaussianBlur {
 public:
  explicit GaussianBlur(int max_width);
  /// Rows [first_row, last_row) of the smoothed `src` into `dst`, which has the same size.
  void apply(const PaddedImage& src, int first_row, int last_row, PaddedImage* dst);

 private:
  void blur_row(const PaddedImage& src, int y, std::uint16_t* out);

  std::vector<std::uint8_t> mirrored_;        ///< one row with three mirrored pixels on both sides
  std::vector<std::uint16_t> ring_;           ///< eight horizontally smoothed rows, 8 fractional bits
  std::size_t ring_stride_;
};

}  // namespace camloc
