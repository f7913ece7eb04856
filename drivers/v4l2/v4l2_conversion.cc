// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The loops over rows are plain, for compilers to put into vectors.
#include "drivers/v4l2/v4l2_conversion.h"

#include <algorithm>
#include <cassert>

#include "core/io/image_file.h"
#include "drivers/raw_pixels.h"

namespace camloc {

namespace {

const std::uint8_t* row_of(const V4l2ImageLayout& layout, const V4l2Planes& planes, unsigned plane, int y) {
  return planes[plane].data() + static_cast<std::size_t>(y) * layout.stride_bytes[plane];
}

/// The interleaved U and V of the row pair that row `y` belongs to.
const std::uint8_t* nv12_chroma_row(const V4l2ImageLayout& layout, const V4l2Planes& planes, int y) {
  if (layout.format->num_planes == 2) return row_of(layout, planes, 1, y / 2);
  return row_of(layout, planes, 0, layout.height + y / 2);
}

ImageView<std::uint8_t> mosaic_of(const V4l2ImageLayout& layout, const V4l2Planes& planes) {
  return {planes[0].data(), layout.width, layout.height, static_cast<int>(layout.stride_bytes[0])};
}

template <bool kIsBigEndian>
std::uint16_t word_at(const std::uint8_t* bytes) {
  return static_cast<std::uint16_t>(kIsBigEndian ? bytes[0] << 8 | bytes[1] : bytes[1] << 8 | bytes[0]);
}

template <bool kIsBigEndian>
void gray_of_words(const std::uint8_t* row, int width, unsigned shift, std::uint8_t* gray) {
  for (int x = 0; x < width; ++x) {
    const unsigned value = static_cast<unsigned>(word_at<kIsBigEndian>(row + 2 * x)) >> shift;
    gray[x] = static_cast<std::uint8_t>(value > 255 ? 255 : value);
  }
}

// A row at a time through a piece of the stack: grey of packed pixels needs no buffer of its own.
void gray_of_packed(const std::uint8_t* row, int width, const V4l2PixelFormat& format, unsigned shift, std::uint8_t* gray) {
  constexpr int kPiece = 512;  // a multiple of 8 pixels, so that pieces start at whole bytes
  std::uint16_t piece[kPiece];
  for (int x = 0; x < width; x += kPiece) {
    const int count = std::min(kPiece, width - x);
    unpack_pixels(row + packed_bytes(static_cast<std::size_t>(x), format.row_bits), static_cast<std::size_t>(count), format.row_bits,
                  piece);
    for (int i = 0; i < count; ++i) gray[x + i] = static_cast<std::uint8_t>(std::min(piece[i] >> shift, 255));
  }
}

void gray_row(const V4l2ImageLayout& layout, const std::uint8_t* row, unsigned shift, std::uint8_t* gray) {
  const int width = layout.width;
  switch (layout.format->layout) {
    case PixelLayout::kYuyv:
      for (int x = 0; x < width; ++x) gray[x] = row[2 * x];
      break;
    case PixelLayout::kUyvy:
      for (int x = 0; x < width; ++x) gray[x] = row[2 * x + 1];
      break;
    case PixelLayout::kWords: gray_of_words<false>(row, width, shift, gray); break;
    case PixelLayout::kWordsBe: gray_of_words<true>(row, width, shift, gray); break;
    case PixelLayout::kPacked: gray_of_packed(row, width, *layout.format, shift, gray); break;
    default: std::copy_n(row, width, gray); break;
  }
}

/// Only a JPEG of the size that was agreed on is decoded: a broken header must not choose how much memory is taken.
Status decode_frame(const V4l2ImageLayout& layout, const V4l2Planes& planes, PixelKind kind, Image<std::uint8_t>* image) {
  static const std::string kName = "MJPEG frame";
  const Result<ImageSize> size = decode_jpeg(planes[0], kName, kind, nullptr);
  if (!size) return size.status();
  if (size->width != layout.width || size->height != layout.height) {
    return {ErrorCode::kCorrupt, kName + " of " + std::to_string(size->width) + "x" + std::to_string(size->height) + " pixels where " +
                                     std::to_string(layout.width) + "x" + std::to_string(layout.height) + " was agreed on"};
  }
  if (Status status = decode_jpeg(planes[0], kName, kind, &image->pixels).status(); !status) return status;
  image->width = size->width;
  image->height = size->height;
  return Status::ok();
}

/// Y, U, V to colour in 16.16 fixed point, from the definition: R = Y + 2 (1 - kr) V, B = Y + 2 (1 - kb) U, and green is what Y
/// has left (ITU-R BT.601, BT.709).
class YuvToBgr {
 public:
  explicit YuvToBgr(const YuvEncoding& encoding) {
    const double kr = encoding.is_bt709 ? 0.2126 : 0.299, kb = encoding.is_bt709 ? 0.0722 : 0.114, kg = 1 - kr - kb;
    const double y_scale = encoding.is_full_range ? 1 : 255.0 / 219, c_scale = encoding.is_full_range ? 1 : 255.0 / 224;
    y_offset_ = encoding.is_full_range ? 0 : 16;
    y_ = fixed(y_scale);
    red_v_ = fixed(2 * (1 - kr) * c_scale);
    blue_u_ = fixed(2 * (1 - kb) * c_scale);
    green_u_ = fixed(2 * (1 - kb) * kb / kg * c_scale);
    green_v_ = fixed(2 * (1 - kr) * kr / kg * c_scale);
  }
  [[nodiscard]] Bgr operator()(int y, int u, int v) const {
    const int luma = y_ * (y - y_offset_) + (1 << 15);
    u -= 128;
    v -= 128;
    return {clipped(luma + blue_u_ * u), clipped(luma - green_u_ * u - green_v_ * v), clipped(luma + red_v_ * v)};
  }

 private:
  static int fixed(double value) { return static_cast<int>(value * 65536 + 0.5); }
  static std::uint8_t clipped(int value) { return static_cast<std::uint8_t>(std::clamp(value >> 16, 0, 255)); }
  int y_offset_, y_, red_v_, blue_u_, green_u_, green_v_;
};

/// `luma` and the two chroma bytes of the pair that pixel x is in: their places in a row.
struct YuvPlaces {
  int y_step, y_first, u, v, pair_step;
};

void bgr_rows_of_yuv(const V4l2ImageLayout& layout, const V4l2Planes& planes, Image<Bgr>* color) {
  const YuvToBgr convert(layout.encoding);
  const PixelLayout kind = layout.format->layout;
  const YuvPlaces at = kind == PixelLayout::kYuyv   ? YuvPlaces{2, 0, 1, 3, 4}
                       : kind == PixelLayout::kUyvy ? YuvPlaces{2, 1, 0, 2, 4}
                                                    : YuvPlaces{1, 0, 0, 1, 2};
  for (int y = 0; y < layout.height; ++y) {
    const std::uint8_t* luma = row_of(layout, planes, 0, y);
    const std::uint8_t* chroma = kind == PixelLayout::kNv12 ? nv12_chroma_row(layout, planes, y) : luma;
    Bgr* out = color->row(y);
    for (int x = 0; x < layout.width; ++x) {
      const std::uint8_t* pair = chroma + x / 2 * at.pair_step;
      out[x] = convert(luma[x * at.y_step + at.y_first], pair[at.u], pair[at.v]);
    }
  }
}

}  // namespace

Status convert_to_gray(const V4l2ImageLayout& layout, const V4l2Planes& planes, unsigned significant_bits, Image<std::uint8_t>* gray) {
  assert(layout.format->can_be_image && significant_bits >= 8 && significant_bits <= 16);
  if (layout.format->layout == PixelLayout::kJpeg) return decode_frame(layout, planes, PixelKind::kGray, gray);
  if (layout.format->layout == PixelLayout::kBayer) {
    bayer_to_gray(mosaic_of(layout, planes), layout.format->order, gray);
    return Status::ok();
  }
  gray->resize(layout.width, layout.height);
  for (int y = 0; y < layout.height; ++y) gray_row(layout, row_of(layout, planes, 0, y), significant_bits - 8, gray->row(y));
  return Status::ok();
}

Status convert_to_bgr(const V4l2ImageLayout& layout, const V4l2Planes& planes, Image<std::uint8_t>* scratch, Image<Bgr>* color) {
  assert(layout.format->has_color);
  if (layout.format->layout == PixelLayout::kBayer) {
    bayer_to_bgr(mosaic_of(layout, planes), layout.format->order, color);
    return Status::ok();
  }
  color->resize(layout.width, layout.height);
  if (layout.format->layout != PixelLayout::kJpeg) {
    bgr_rows_of_yuv(layout, planes, color);
    return Status::ok();
  }
  if (Status status = decode_frame(layout, planes, PixelKind::kColor, scratch); !status) return status;
  rgb_to_bgr(scratch->pixels, color);
  return Status::ok();
}

void convert_to_depth(const V4l2ImageLayout& layout, const V4l2Planes& planes, Image<std::uint16_t>* depth) {
  assert(layout.format->can_be_depth);
  depth->resize(layout.width, layout.height);
  const auto width = static_cast<std::size_t>(layout.width);
  for (int y = 0; y < layout.height; ++y) {
    const std::uint8_t* row = row_of(layout, planes, 0, y);
    std::uint16_t* out = depth->row(y);
    switch (layout.format->layout) {
      case PixelLayout::kPacked: unpack_pixels(row, width, layout.format->row_bits, out); break;
      case PixelLayout::kWordsBe:
        for (std::size_t x = 0; x < width; ++x) out[x] = word_at<true>(row + 2 * x);
        break;
      default:
        for (std::size_t x = 0; x < width; ++x) out[x] = word_at<false>(row + 2 * x);
        break;
    }
  }
}

}  // namespace camloc
