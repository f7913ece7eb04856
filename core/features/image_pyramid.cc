// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/image_pyramid.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>

namespace camloc {
namespace {

/// Taps of one axis. The scale is the reciprocal of a reciprocal and weights are rounded half to even, as in OpenCV.
std::vector<ResizeTap> make_taps(int src_size, int dst_size) {
  std::vector<ResizeTap> taps(static_cast<std::size_t>(dst_size));
  const double scale = 1.0 / (static_cast<double>(dst_size) / src_size);
  for (int i = 0; i < dst_size; ++i) {
    const double position = scale * (i + 0.5) - 0.5;
    const int offset = static_cast<int>(std::floor(position));
    ResizeTap& tap = taps[static_cast<std::size_t>(i)];
    if (offset < 0) {
      tap = {0, 0};
    } else if (offset >= src_size - 1) {
      tap = {src_size - 1, 0};
    } else {
      tap = {offset, static_cast<std::uint16_t>(std::nearbyint((position - offset) * 256))};
    }
  }
  return taps;
}

}  // namespace

void PaddedImage::allocate(int new_width, int new_height) {
  width = new_width;
  height = new_height;
  stride = (new_width + kPadding + 63) / 64 * 64;
  pixels.assign(static_cast<std::size_t>(stride) * static_cast<std::size_t>(new_height) + kPadding, 0);
}

ExactResize::ExactResize(int src_width, int src_height, int dst_width, int dst_height)
    : columns_(make_taps(src_width, dst_width)), rows_(make_taps(src_height, dst_height)) {
  for (auto& buffer : row_buffer_) buffer.resize(static_cast<std::size_t>(dst_width + PaddedImage::kPadding));
}

void ExactResize::resize_row(const std::uint8_t* src, std::uint16_t* dst) const {
  for (const ResizeTap& tap : columns_) {
    // A weight of 0 reads the pixel after the last one; rows are padded.
    const std::uint8_t* pixel = src + tap.offset;
    *dst++ = static_cast<std::uint16_t>(pixel[0] * (256 - tap.weight) + pixel[1] * tap.weight);
  }
}

void ExactResize::apply(const PaddedImage& src, PaddedImage* dst) {
  int row_in_buffer[2] = {-1, -1};
  const auto resized_row = [&](int y) {
    const int slot = y & 1;
    if (row_in_buffer[slot] != y) resize_row(src.row(y), row_buffer_[slot].data());
    row_in_buffer[slot] = y;
    return row_buffer_[slot].data();
  };
  for (int y = 0; y < dst->height; ++y) {
    const ResizeTap tap = rows_[static_cast<std::size_t>(y)];
    const std::uint16_t* first = resized_row(tap.offset);
    const std::uint16_t* second = tap.weight > 0 ? resized_row(tap.offset + 1) : first;
    std::uint8_t* out = dst->row(y);
    const std::uint32_t weight = tap.weight;
    for (int x = 0; x < dst->width; ++x)
      out[x] = static_cast<std::uint8_t>((first[x] * (256 - weight) + second[x] * weight + 32768) >> 16);
  }
}

ImagePyramid::ImagePyramid(int width, int height, int num_levels, float scale_factor) {
  assert(width > 0 && height > 0 && num_levels > 0 && scale_factor > 1);
  for (int level = 0; level < num_levels; ++level) {
    const auto scale = static_cast<float>(std::pow(static_cast<double>(scale_factor), level));
    const int level_width = static_cast<int>(std::lrint(static_cast<float>(width) / scale));
    const int level_height = static_cast<int>(std::lrint(static_cast<float>(height) / scale));
    if (level_width < 1 || level_height < 1) break;
    scales_.push_back(scale);
    levels_.emplace_back().allocate(level_width, level_height);
    if (level > 0) {
      const PaddedImage& previous = levels_[levels_.size() - 2];
      resizes_.emplace_back(previous.width, previous.height, level_width, level_height);
    }
  }
}

void ImagePyramid::build(ImageView<std::uint8_t> image) {
  PaddedImage& base = levels_[0];
  assert(image.width == base.width && image.height == base.height);
  for (int y = 0; y < base.height; ++y) std::memcpy(base.row(y), image.row(y), static_cast<std::size_t>(base.width));
  for (std::size_t i = 0; i < resizes_.size(); ++i) resizes_[i].apply(levels_[i], &levels_[i + 1]);
}

}  // namespace camloc
