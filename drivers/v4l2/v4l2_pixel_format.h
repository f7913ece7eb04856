// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The pixel formats of V4L2 that are read here, and how many bytes they take (Linux kernel documentation, "Video for Linux
// API", "Image Formats"). Formats are called by their four characters, as v4l2-ctl does.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "drivers/raw_pixels.h"

namespace camloc {

enum class PixelLayout : std::uint8_t {
  kBytes,    ///< one byte of grey
  kYuyv,     ///< Y U Y V
  kUyvy,     ///< U Y V Y
  kNv12,     ///< a plane of Y, then rows of U V at half the resolution
  kBayer,    ///< one byte, its colour by place
  kJpeg,     ///< one JPEG image a frame
  kWords,    ///< 16 bits, low byte first
  kWordsBe,  ///< 16 bits, high byte first
  kPacked,   ///< 10 or 11 bits without gaps, see raw_pixels.h
};

/// What a node is wanted for: the grey (or colour, or infrared) image, or depth.
enum class V4l2Role : std::uint8_t { kImage, kDepth };

struct V4l2PixelFormat {
  std::uint32_t fourcc;
  PixelLayout layout;
  unsigned row_bits;          ///< of a pixel in the first plane; 0 for JPEG
  unsigned significant_bits;  ///< of a grey or depth value
  bool has_color;
  bool can_be_image;  ///< colour, grey or infrared
  bool can_be_depth;
  unsigned num_planes = 1;  ///< of memory; the two parts of NV12 share one
  BayerOrder order = BayerOrder::kRggb;

  [[nodiscard]] bool fits(V4l2Role role) const { return role == V4l2Role::kImage ? can_be_image : can_be_depth; }
};

/// In the order of preference for images, all else being equal: what costs least to turn into grey comes first.
[[nodiscard]] std::span<const V4l2PixelFormat> v4l2_pixel_formats();
/// nullptr for one that is not read here.
[[nodiscard]] const V4l2PixelFormat* find_v4l2_pixel_format(std::uint32_t fourcc);

/// "YUYV", "Z16", "Y16-BE"; bytes that do not print become '?'.
[[nodiscard]] std::string fourcc_name(std::uint32_t fourcc);
/// The inverse for formats that are read here; case does not matter, and MJPEG, NV12M and the four orders of Bayer pixels have
/// their usual names, too.
[[nodiscard]] std::optional<std::uint32_t> parse_fourcc(std::string_view name);

/// Bytes of one row of the first plane without padding, and of a whole plane with `stride` bytes from row to row, padding behind
/// the last row left out. 0 for JPEG. Plane 1 exists for two-plane formats alone.
[[nodiscard]] std::size_t min_row_bytes(const V4l2PixelFormat& format, int width);
[[nodiscard]] std::size_t min_plane_bytes(const V4l2PixelFormat& format, unsigned plane, int width, int height, std::size_t stride);

}  // namespace camloc
