// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/v4l2/v4l2_pixel_format.h"

#include <linux/videodev2.h>

#include <algorithm>
#include <cctype>
#include <utility>

namespace camloc {

namespace {

// Not in the kernel's list: what out-of-tree Kinect drivers call 11 bits packed.
constexpr std::uint32_t kY11 = v4l2_fourcc('Y', '1', '1', ' ');
constexpr std::uint32_t kY11Packed = v4l2_fourcc('Y', '1', '1', 'B');

constexpr V4l2PixelFormat kFormats[] = {
    // fourcc, layout, bits a pixel in a row, significant bits, colour, image, depth
    {V4L2_PIX_FMT_GREY, PixelLayout::kBytes, 8, 8, false, true, false},
    {V4L2_PIX_FMT_YUYV, PixelLayout::kYuyv, 16, 8, true, true, false},
    {V4L2_PIX_FMT_UYVY, PixelLayout::kUyvy, 16, 8, true, true, false},
    {V4L2_PIX_FMT_NV12, PixelLayout::kNv12, 8, 8, true, true, false},
    {V4L2_PIX_FMT_NV12M, PixelLayout::kNv12, 8, 8, true, true, false, 2},
    {V4L2_PIX_FMT_SRGGB8, PixelLayout::kBayer, 8, 8, true, true, false, 1, BayerOrder::kRggb},
    {V4L2_PIX_FMT_SGRBG8, PixelLayout::kBayer, 8, 8, true, true, false, 1, BayerOrder::kGrbg},
    {V4L2_PIX_FMT_SGBRG8, PixelLayout::kBayer, 8, 8, true, true, false, 1, BayerOrder::kGbrg},
    {V4L2_PIX_FMT_SBGGR8, PixelLayout::kBayer, 8, 8, true, true, false, 1, BayerOrder::kBggr},
    {V4L2_PIX_FMT_MJPEG, PixelLayout::kJpeg, 0, 8, true, true, false},
    {V4L2_PIX_FMT_JPEG, PixelLayout::kJpeg, 0, 8, true, true, false},
    {V4L2_PIX_FMT_Y10, PixelLayout::kWords, 16, 10, false, true, true},
    {V4L2_PIX_FMT_Y10BPACK, PixelLayout::kPacked, 10, 10, false, true, true},
    {V4L2_PIX_FMT_Y12, PixelLayout::kWords, 16, 12, false, true, true},
    {V4L2_PIX_FMT_Y16, PixelLayout::kWords, 16, 16, false, true, true},
    {V4L2_PIX_FMT_Y16_BE, PixelLayout::kWordsBe, 16, 16, false, true, true},
    {kY11, PixelLayout::kPacked, 11, 11, false, false, true},
    {kY11Packed, PixelLayout::kPacked, 11, 11, false, false, true},
    {V4L2_PIX_FMT_Z16, PixelLayout::kWords, 16, 16, false, false, true},
};

constexpr std::pair<std::string_view, std::uint32_t> kAliases[] = {
    {"MJPEG", V4L2_PIX_FMT_MJPEG}, {"NV12M", V4L2_PIX_FMT_NV12M},    {"BGGR", V4L2_PIX_FMT_SBGGR8},
    {"Y8", V4L2_PIX_FMT_GREY},     {"Y16 -BE", V4L2_PIX_FMT_Y16_BE},
};

constexpr std::uint32_t kBigEndianBit = 1U << 31;

std::size_t pairs(int pixels) { return (static_cast<std::size_t>(pixels) + 1) / 2; }

}  // namespace

std::span<const V4l2PixelFormat> v4l2_pixel_formats() { return kFormats; }

const V4l2PixelFormat* find_v4l2_pixel_format(std::uint32_t fourcc) {
  const auto* format = std::find_if(std::begin(kFormats), std::end(kFormats), [&](const V4l2PixelFormat& f) { return f.fourcc == fourcc; });
  return format == std::end(kFormats) ? nullptr : format;
}

std::string fourcc_name(std::uint32_t fourcc) {
  std::string name;
  for (unsigned shift = 0; shift < 32; shift += 8) {
    const auto c = static_cast<char>((fourcc & ~kBigEndianBit) >> shift & 0xFF);
    name += c < 32 || c == 127 ? '?' : c;
  }
  while (!name.empty() && name.back() == ' ') name.pop_back();
  if ((fourcc & kBigEndianBit) != 0) name += "-BE";
  return name;
}

std::optional<std::uint32_t> parse_fourcc(std::string_view name) {
  std::string upper(name);
  std::transform(upper.begin(), upper.end(), upper.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  for (const V4l2PixelFormat& format : kFormats) {
    if (fourcc_name(format.fourcc) == upper) return format.fourcc;
  }
  for (const auto& [alias, fourcc] : kAliases) {
    if (alias == upper) return fourcc;
  }
  return std::nullopt;
}

std::size_t min_row_bytes(const V4l2PixelFormat& format, int width) {
  if (format.layout == PixelLayout::kYuyv || format.layout == PixelLayout::kUyvy) return 4 * pairs(width);
  if (format.layout == PixelLayout::kNv12) return 2 * pairs(width);  // the rows of chroma, which share the stride
  return (static_cast<std::size_t>(width) * format.row_bits + 7) / 8;
}

std::size_t min_plane_bytes(const V4l2PixelFormat& format, unsigned plane, int width, int height, std::size_t stride) {
  if (format.layout == PixelLayout::kJpeg) return 0;
  const auto rows = static_cast<std::size_t>(height);
  if (format.layout != PixelLayout::kNv12) return stride * (rows - 1) + min_row_bytes(format, width);
  const std::size_t chroma = stride * (pairs(height) - 1) + 2 * pairs(width);
  if (plane == 1) return chroma;
  return format.num_planes == 2 ? stride * (rows - 1) + min_row_bytes(format, width) : stride * rows + chroma;
}

}  // namespace camloc
