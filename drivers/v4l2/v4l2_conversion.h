// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A frame's bytes to grey, depth or colour pixels. Whoever calls has checked that the bytes are there; a JPEG alone can still
// be broken.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/frame.h"
#include "core/base/result.h"
#include "drivers/v4l2/v4l2_pixel_format.h"

namespace camloc {

/// Which weights made Y, U and V from red, green and blue, and whether Y spans 16 to 235 or 0 to 255.
struct YuvEncoding {
  bool is_bt709 = false;  ///< else ITU-R BT.601
  bool is_full_range = false;
};

/// What negotiation agreed on: how the bytes of a frame lie.
struct V4l2ImageLayout {
  const V4l2PixelFormat* format = nullptr;
  int width = 0, height = 0;
  std::array<std::size_t, 2> stride_bytes{};  ///< from row to row of each plane; at least min_row_bytes()
  YuvEncoding encoding;

  [[nodiscard]] std::size_t plane_bytes(unsigned plane) const {
    return min_plane_bytes(*format, plane, width, height, stride_bytes[plane]);
  }
};

/// At least min_plane_bytes() each; of a JPEG as many as the frame has.
using V4l2Planes = std::array<std::span<const std::uint8_t>, 2>;

/// Grey of an image format. Y of the YUV formats is taken as it is, Bayer pixels go through bayer_to_gray(), and of wider pixels
/// the upper 8 of `significant_bits` (8 to 16) are kept; brighter ones saturate. kCorrupt: the JPEG is broken or of another size.
[[nodiscard]] Status convert_to_gray(const V4l2ImageLayout& layout, const V4l2Planes& planes, unsigned significant_bits,
                                     Image<std::uint8_t>* gray);

/// Colour of a format that has some; errors as above. `scratch` is reused from frame to frame.
[[nodiscard]] Status convert_to_bgr(const V4l2ImageLayout& layout, const V4l2Planes& planes, Image<std::uint8_t>* scratch,
                                    Image<Bgr>* color);

/// Raw values of a depth format.
void convert_to_depth(const V4l2ImageLayout& layout, const V4l2Planes& planes, Image<std::uint16_t>* depth);

}  // namespace camloc
