// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The smoothing before rotated BRIEF: Gaussian 7 x 7, sigma 2, mirrored at the border without repeating the edge pixel.
// The numbers are those cv::ORB gets from cv::GaussianBlur. Its levels are parts of one larger image, for which OpenCV sums
// in float and not with the 8-bit weights it takes for an image of its own. The two agree but for sums within float
// rounding of the middle between two grey levels: less than 1 pixel in 10^4.
#pragma once

#include <cstdint>
#include <vector>

#include "core/features/image_pyramid.h"

namespace camloc {

/// Allocates at construction only. Not thread-safe.
class GaussianBlur {
 public:
  explicit GaussianBlur(int max_width);
  /// The smoothed `src` into `dst`, which has the same size.
  void apply(const PaddedImage& src, PaddedImage* dst);

 private:
  void blur_row(const PaddedImage& src, int y, float* out);

  std::vector<std::uint8_t> mirrored_;  ///< one row with three mirrored pixels on both sides
  std::vector<float> ring_;             ///< eight horizontally smoothed rows
  std::size_t ring_stride_;
};

}  // namespace camloc
