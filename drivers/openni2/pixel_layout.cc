// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// One loop over rows and columns, a small reader per layout.
#include "drivers/openni2/pixel_layout.h"

#include <OniCEnums.h>

#include <algorithm>

namespace camloc::openni2 {

namespace {

std::uint8_t clamp_to_byte(int value) { return static_cast<std::uint8_t>(std::clamp(value, 0, 255)); }

/// ITU-R BT.601 with 8-bit fixed-point weights, from R'G'B' of full range.
std::uint8_t luma(const Bgr& pixel) { return static_cast<std::uint8_t>((77 * pixel.r + 150 * pixel.g + 29 * pixel.b + 128) >> 8); }

/// BT.601 limited range (16..235, 16..240) to full range, 8-bit fixed point.
Bgr from_yuv(int y, int u, int v) {
  const int c = 298 * (y - 16) + 128;
  const int d = u - 128;
  const int e = v - 128;
  return {clamp_to_byte((c + 516 * d) >> 8), clamp_to_byte((c - 100 * d - 208 * e) >> 8), clamp_to_byte((c + 409 * e) >> 8)};
}

std::uint8_t luma_of_limited(int y) { return clamp_to_byte((298 * (y - 16) + 128) >> 8); }

std::uint16_t load_u16(const std::uint8_t* bytes) { return static_cast<std::uint16_t>(bytes[0] | bytes[1] << 8); }

std::uint8_t infrared_to_byte(const std::uint8_t* bytes) { return static_cast<std::uint8_t>(std::min(255, load_u16(bytes) >> 2)); }

/// Pixel x of a row, per layout. A pair of YUV pixels shares its chroma.
std::uint8_t gray_at(PixelLayout layout, const std::uint8_t* row, int x) {
  switch (layout) {
    case PixelLayout::kGray8: return row[x];
    case PixelLayout::kGray16: return infrared_to_byte(row + 2 * x);
    case PixelLayout::kRgb24: return luma({row[3 * x + 2], row[3 * x + 1], row[3 * x]});
    case PixelLayout::kUyvy: return luma_of_limited(row[2 * x + 1]);
    case PixelLayout::kYuyv: return luma_of_limited(row[2 * x]);
    default: return 0;
  }
}

Bgr bgr_at(PixelLayout layout, const std::uint8_t* row, int x) {
  const std::uint8_t* pair = row + 4 * (x / 2);
  switch (layout) {
    case PixelLayout::kRgb24: return {row[3 * x + 2], row[3 * x + 1], row[3 * x]};
    case PixelLayout::kUyvy: return from_yuv(row[2 * x + 1], pair[0], pair[2]);
    case PixelLayout::kYuyv: return from_yuv(row[2 * x], pair[1], pair[3]);
    default: {
      const std::uint8_t gray = gray_at(layout, row, x);
      return {gray, gray, gray};
    }
  }
}

/// The layout is a constant inside the loop, so that its switch is decided before it.
template <PixelLayout layout, typename Pixel, typename Read>
void convert_rows(const RawImage& image, Image<Pixel>* out, Read read) {
  out->resize(image.width, image.height);
  for (int y = 0; y < image.height; ++y) {
    const std::uint8_t* row = image.bytes.data() + static_cast<std::size_t>(y) * image.stride_bytes;
    Pixel* to = out->row(y);
    if (image.is_mirrored) {
      for (int x = 0; x < image.width; ++x) to[image.width - 1 - x] = read(layout, row, x);
    } else {
      for (int x = 0; x < image.width; ++x) to[x] = read(layout, row, x);
    }
  }
}

template <typename Pixel, typename Read>
Status convert(const RawImage& image, Image<Pixel>* out, Read read) {
  if (Status status = check_raw_image(image); !status) return status;
  switch (image.layout) {
    case PixelLayout::kGray8: convert_rows<PixelLayout::kGray8>(image, out, read); break;
    case PixelLayout::kGray16: convert_rows<PixelLayout::kGray16>(image, out, read); break;
    case PixelLayout::kRgb24: convert_rows<PixelLayout::kRgb24>(image, out, read); break;
    case PixelLayout::kUyvy: convert_rows<PixelLayout::kUyvy>(image, out, read); break;
    case PixelLayout::kYuyv: convert_rows<PixelLayout::kYuyv>(image, out, read); break;
    default: return {ErrorCode::kUnsupported, std::string("pixels of layout ") + name_of(image.layout) + " are no colour"};
  }
  return Status::ok();
}

/// Reads codes and writes numbers; the first thing that does not fit stops it for good.
class Decoder {
 public:
  Decoder(std::span<const std::uint8_t> bytes, std::span<std::uint16_t> depth) : bytes_(bytes), depth_(depth) {}

  [[nodiscard]] bool read_table() {
    const std::size_t count = read_u16();
    if (failed_ || bytes_.size() - position_ < 2 * count) return false;
    table_ = bytes_.subspan(position_, 2 * count);
    has_table_ = true;
    position_ += 2 * count;
    return true;
  }

  [[nodiscard]] bool run() {
    last_ = read_u16();
    if (!failed_) put();
    while (!failed_ && position_ < bytes_.size()) read_code();
    return !failed_ && num_written_ == depth_.size();
  }

 private:
  void read_code() {
    const int code = read_byte();
    if (code == 0xFF) return read_full();
    if (code >= 0xE0) {
      for (int i = 0; i < 2 * (code - 0xE0); ++i) put();
      return;
    }
    step((code >> 4) - 6);
    const int low = code & 0xF;
    if (low == 0xF) {
      read_full();
    } else if (low != 0xD) {
      step(low - 6);
    }
  }

  void read_full() {
    const int first = read_byte();
    if (first >= 0x80) return step(first - 192);
    last_ = static_cast<std::uint16_t>(first << 8 | read_byte());
    put();
  }

  void step(int difference) {
    last_ = static_cast<std::uint16_t>(last_ - difference);
    put();
  }

  void put() {
    std::uint16_t value = last_;
    if (has_table_) {
      if (2 * static_cast<std::size_t>(last_) >= table_.size()) {
        failed_ = true;
        return;
      }
      value = static_cast<std::uint16_t>(table_[2U * last_] | table_[2U * last_ + 1] << 8);
    }
    if (failed_ || num_written_ == depth_.size()) {
      failed_ = true;
      return;
    }
    depth_[num_written_++] = value;
  }

  int read_byte() {
    if (position_ < bytes_.size()) return bytes_[position_++];
    failed_ = true;
    return 0;
  }
  std::uint16_t read_u16() {
    const int low = read_byte();
    return static_cast<std::uint16_t>(low | read_byte() << 8);
  }

  std::span<const std::uint8_t> bytes_;
  std::span<std::uint16_t> depth_;
  std::span<const std::uint8_t> table_;
  bool has_table_ = false;
  bool failed_ = false;
  std::uint16_t last_ = 0;
  std::size_t position_ = 0;
  std::size_t num_written_ = 0;
};

}  // namespace

std::optional<PixelFormat> pixel_format_of(int oni_pixel_format) {
  switch (oni_pixel_format) {
    case ONI_PIXEL_FORMAT_DEPTH_1_MM: return PixelFormat{PixelLayout::kDepth16, 1e-3};
    case ONI_PIXEL_FORMAT_DEPTH_100_UM: return PixelFormat{PixelLayout::kDepth16, 1e-4};
    case ONI_PIXEL_FORMAT_RGB888: return PixelFormat{PixelLayout::kRgb24, 0};
    case ONI_PIXEL_FORMAT_YUV422: return PixelFormat{PixelLayout::kUyvy, 0};
    case ONI_PIXEL_FORMAT_YUYV: return PixelFormat{PixelLayout::kYuyv, 0};
    case ONI_PIXEL_FORMAT_GRAY8: return PixelFormat{PixelLayout::kGray8, 0};
    case ONI_PIXEL_FORMAT_GRAY16: return PixelFormat{PixelLayout::kGray16, 0};
    case ONI_PIXEL_FORMAT_JPEG: return PixelFormat{PixelLayout::kJpeg, 0};
    default: return std::nullopt;
  }
}

const char* name_of(PixelLayout layout) {
  switch (layout) {
    case PixelLayout::kGray8: return "GRAY8";
    case PixelLayout::kGray16: return "GRAY16";
    case PixelLayout::kRgb24: return "RGB888";
    case PixelLayout::kUyvy: return "YUV422";
    case PixelLayout::kYuyv: return "YUYV";
    case PixelLayout::kDepth16: return "DEPTH";
    case PixelLayout::kJpeg: return "JPEG";
  }
  return "?";
}

std::size_t bytes_per_pixel(PixelLayout layout) {
  switch (layout) {
    case PixelLayout::kGray8: return 1;
    case PixelLayout::kRgb24: return 3;
    case PixelLayout::kJpeg: return 0;
    default: return 2;
  }
}

Status check_raw_image(const RawImage& image) {
  constexpr int kMaxSide = 16384;
  // The words are put together on an error alone: this is on the path of every frame.
  const auto bad = [&image](const std::string& why) {
    return Status(ErrorCode::kCorrupt,
                  "image of " + std::to_string(image.width) + "x" + std::to_string(image.height) + " " + name_of(image.layout) + " " + why);
  };
  if (image.width <= 0 || image.height <= 0 || image.width > kMaxSide || image.height > kMaxSide) return bad("is out of range");
  const bool has_pairs = image.layout == PixelLayout::kUyvy || image.layout == PixelLayout::kYuyv;
  if (has_pairs && image.width % 2 != 0) return bad("has an odd width and so no pairs of pixels");
  const std::size_t row_bytes = static_cast<std::size_t>(image.width) * bytes_per_pixel(image.layout);
  if (row_bytes == 0) return bad("is compressed");
  // Compared by division: a stride that lies must not wrap the product.
  const bool is_fine = image.stride_bytes >= row_bytes && image.bytes.size() >= row_bytes &&
                       (image.bytes.size() - row_bytes) / image.stride_bytes >= static_cast<std::size_t>(image.height - 1);
  if (is_fine) return Status::ok();
  return bad("with " + std::to_string(image.stride_bytes) + " bytes a row does not fit into " + std::to_string(image.bytes.size()) +
             " bytes");
}

Status to_gray(const RawImage& image, Image<std::uint8_t>* gray) { return convert(image, gray, gray_at); }

Status to_bgr(const RawImage& image, Image<Bgr>* color) { return convert(image, color, bgr_at); }

Status to_depth(const RawImage& image, Image<std::uint16_t>* depth) {
  if (image.layout != PixelLayout::kDepth16)
    return {ErrorCode::kUnsupported, std::string("pixels of layout ") + name_of(image.layout) + " are no depth"};
  if (Status status = check_raw_image(image); !status) return status;
  convert_rows<PixelLayout::kDepth16>(image, depth, [](PixelLayout, const std::uint8_t* row, int x) { return load_u16(row + 2 * x); });
  return Status::ok();
}

Status decode_depth_codec(OniCodec codec, std::span<const std::uint8_t> bytes, std::span<std::uint16_t> depth) {
  Decoder decoder(bytes, depth);
  if ((codec != OniCodec::k16zTable || decoder.read_table()) && decoder.run()) return Status::ok();
  return {ErrorCode::kCorrupt, "compressed depth does not give " + std::to_string(depth.size()) + " pixels"};
}

}  // namespace camloc::openni2
