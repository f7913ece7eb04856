// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Scale pyramid of a grey image. Sizes and pixels equal those inside cv::ORB: each level is made from the one before it
// by OpenCV's INTER_LINEAR_EXACT (8-bit fixed-point weights, one rounding at the end).
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/frame.h"

namespace camloc {

/// A grey image with room after each row: kernels may read and write kPadding pixels past the end of a row.
struct PaddedImage {
  static constexpr int kPadding = 64;

  std::vector<std::uint8_t> pixels;
  int width = 0, height = 0, stride = 0;

  void allocate(int new_width, int new_height);
  [[nodiscard]] std::uint8_t* row(int y) { return pixels.data() + static_cast<std::ptrdiff_t>(y) * stride; }
  [[nodiscard]] const std::uint8_t* row(int y) const { return pixels.data() + static_cast<std::ptrdiff_t>(y) * stride; }
};

/// Where a destination pixel comes from along one axis: (src[offset] * (256 - weight) + src[offset + 1] * weight) / 256.
struct ResizeTap {
  std::int32_t offset = 0;
  std::uint16_t weight = 0;  ///< of the second pixel, 0..256; 0 where there is no second pixel
};

/// Sixteen neighbouring columns for a vector kernel: each half takes its pixels from 16 source pixels.
struct alignas(32) ResizeBlock {
  std::uint8_t shuffle[32] = {};  ///< byte 2 i, 2 i + 1: the two pixels of column i, counted from the half's offset
  std::uint16_t weight[16] = {};
  std::int32_t offset[2] = {};
};

/// Linear resize with the arithmetic of cv::INTER_LINEAR_EXACT for one pair of sizes. Allocates at construction only.
class ExactResize {
 public:
  ExactResize(int src_width, int src_height, int dst_width, int dst_height);
  /// `src` and `dst` have the sizes given at construction.
  void apply(const PaddedImage& src, PaddedImage* dst);

 private:
  std::vector<ResizeTap> columns_, rows_;
  std::vector<ResizeBlock> blocks_;           ///< the columns again for the vector kernel; empty where it cannot be used
  std::vector<std::uint16_t> row_buffer_[2];  ///< horizontally resized source rows, 8 fractional bits
};

/// Allocates at construction only. Not thread-safe.
class ImagePyramid {
 public:
  ImagePyramid(int width, int height, int num_levels, float scale_factor);
  /// `image` has the size given at construction.
  void build(ImageView<std::uint8_t> image);

  [[nodiscard]] int num_levels() const { return static_cast<int>(levels_.size()); }
  [[nodiscard]] const PaddedImage& level(int level) const { return levels_[static_cast<std::size_t>(level)]; }
  /// Where column x and row y of a level lie on level 0, pixel centres at integers. Sizes are rounded to whole pixels, so that the
  /// ratio of two levels is not quite the scale factor: on the coarsest of eight levels of 640 pixels that is 1.4 px at the edge.
  [[nodiscard]] float column_on_base(int level, float x) const { return (x + 0.5F) * ratio(level, &PaddedImage::width) - 0.5F; }
  [[nodiscard]] float row_on_base(int level, float y) const { return (y + 0.5F) * ratio(level, &PaddedImage::height) - 0.5F; }
  [[nodiscard]] float column_on_level(int level, float u) const { return (u + 0.5F) / ratio(level, &PaddedImage::width) - 0.5F; }
  [[nodiscard]] float row_on_level(int level, float v) const { return (v + 0.5F) / ratio(level, &PaddedImage::height) - 0.5F; }

 private:
  [[nodiscard]] float ratio(int level, int PaddedImage::*size) const {
    return static_cast<float>(levels_[0].*size) / static_cast<float>(levels_[static_cast<std::size_t>(level)].*size);
  }

  std::vector<PaddedImage> levels_;
  std::vector<ExactResize> resizes_;  ///< resizes_[i] makes level i + 1 from level i
};

}  // namespace camloc
