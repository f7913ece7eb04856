// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// PNG to grey or RGB bytes, and to 16-bit depth, through libpng.
#include <png.h>

#include <bit>
#include <csetjmp>
#include <cstring>

#include "core/io/image_file.h"

namespace camloc {

namespace {

/// ITU-R BT.601 weights in 16-bit fixed point, as libjpeg has them: a PNG and a JPEG of one scene look alike.
std::uint8_t luma(const std::uint8_t* rgb) {
  return static_cast<std::uint8_t>((19595U * rgb[0] + 38470U * rgb[1] + 7471U * rgb[2] + 32768U) >> 16);
}

/// What libpng's callbacks need, and the way back from an error.
struct PngState {
  const std::uint8_t* data = nullptr;
  std::size_t size = 0;
  std::size_t position = 0;
  std::jmp_buf way_back{};
  char message[128] = "";
};

[[noreturn]] void on_error(png_structp png, png_const_charp message) {
  auto* state = static_cast<PngState*>(png_get_error_ptr(png));
  std::strncpy(state->message, message, sizeof(state->message) - 1);
  std::longjmp(state->way_back, 1);
}

void on_warning(png_structp, png_const_charp) {}

void on_read(png_structp png, png_bytep out, std::size_t count) {
  auto* state = static_cast<PngState*>(png_get_io_ptr(png));
  if (count > state->size - state->position) png_error(png, "ends too early");
  std::memcpy(out, state->data + state->position, count);
  state->position += count;
}

/// A reader that is torn down on every way out, its errors included.
struct PngDecoder {
  PngState state;
  png_structp png = nullptr;
  png_infop info = nullptr;
  int width = 0, height = 0, bit_depth = 0, color_type = 0, num_passes = 1;

  PngDecoder() = default;
  ~PngDecoder() { png_destroy_read_struct(&png, &info, nullptr); }
  PngDecoder(const PngDecoder&) = delete;
  PngDecoder& operator=(const PngDecoder&) = delete;

  // Between setjmp and longjmp of the three steps below no object is constructed.
  bool read_header(std::span<const std::uint8_t> bytes) {
    state.data = bytes.data();
    state.size = bytes.size();
    if (setjmp(state.way_back) != 0) return false;
    png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &state, on_error, on_warning);
    if (png == nullptr) return false;
    info = png_create_info_struct(png);
    if (info == nullptr) return false;
    png_set_user_limits(png, kMaxImageSide, kMaxImageSide);
    png_set_chunk_malloc_max(png, 1 << 20);
    png_set_read_fn(png, &state, on_read);
    png_read_info(png, info);
    width = static_cast<int>(png_get_image_width(png, info));
    height = static_cast<int>(png_get_image_height(png, info));
    bit_depth = png_get_bit_depth(png, info);
    color_type = png_get_color_type(png, info);
    return true;
  }
  /// Everything with colour becomes RGB, the upper eight bits of sixteen, everything grey one byte; alpha goes.
  bool start_bytes(bool wants_color) {
    if (setjmp(state.way_back) != 0) return false;
    if (color_type == PNG_COLOR_TYPE_PALETTE) png_set_palette_to_rgb(png);
    if (color_type == PNG_COLOR_TYPE_GRAY && bit_depth < 8) png_set_expand_gray_1_2_4_to_8(png);
    if (wants_color && (color_type & PNG_COLOR_MASK_COLOR) == 0) png_set_gray_to_rgb(png);
    if (bit_depth == 16) png_set_strip_16(png);
    png_set_strip_alpha(png);
    return start_rows();
  }
  bool start_depth() {
    if (setjmp(state.way_back) != 0) return false;
    if constexpr (std::endian::native == std::endian::little) png_set_swap(png);
    return start_rows();
  }
  /// Interlaced images come in several passes over the same rows.
  bool start_rows() {
    num_passes = png_set_interlace_handling(png);
    png_read_update_info(png, info);
    return true;
  }
  bool read_rows(std::uint8_t* pixels, std::size_t row_bytes) {
    if (setjmp(state.way_back) != 0) return false;
    if (png_get_rowbytes(png, info) != row_bytes) png_error(png, "unexpected row size");
    for (int pass = 0; pass < num_passes; ++pass) {
      for (int y = 0; y < height; ++y) png_read_row(png, pixels + static_cast<std::size_t>(y) * row_bytes, nullptr);
    }
    png_read_end(png, nullptr);  // checks the last checksum
    return true;
  }
  [[nodiscard]] Status broken(const std::string& name) const {
    return {ErrorCode::kCorrupt, name + ": broken PNG (" + (state.message[0] != '\0' ? state.message : "out of memory") + ")"};
  }
};

/// RGB to grey in place; the grey bytes end up in front.
void squeeze_to_gray(std::vector<std::uint8_t>* pixels, std::size_t count) {
  std::uint8_t* p = pixels->data();
  for (std::size_t i = 0; i < count; ++i) p[i] = luma(p + 3 * i);
  pixels->resize(count);
}

std::string describe(const PngDecoder& decoder) {
  const bool has_color = (decoder.color_type & PNG_COLOR_MASK_COLOR) != 0;
  return std::to_string(decoder.bit_depth) + "-bit " + (has_color ? "colour" : "grey") + " image";
}

}  // namespace

Result<ImageSize> decode_png(std::span<const std::uint8_t> bytes, const std::string& name, PixelKind kind,
                             std::vector<std::uint8_t>* pixels) {
  PngDecoder decoder;
  if (!decoder.read_header(bytes)) return decoder.broken(name);
  if (Status status = check_image_size(decoder.width, decoder.height, name); !status) return status;
  if (pixels == nullptr) return ImageSize{decoder.width, decoder.height};
  const bool has_color = (decoder.color_type & PNG_COLOR_MASK_COLOR) != 0;
  if (decoder.bit_depth > 8 && !has_color) {  // depth, or infrared whose ten bits would be black as eight
    return {ErrorCode::kUnsupported, name + ": " + describe(decoder) +
                                         ", expected 8 bits; convert it (magick IN.png -normalize -depth 8 OUT.png), or are "
                                         "colour and depth exchanged?"};
  }
  const bool wants_color = kind == PixelKind::kColor;
  if (!decoder.start_bytes(wants_color)) return decoder.broken(name);
  const std::size_t num_pixels = static_cast<std::size_t>(decoder.width) * static_cast<std::size_t>(decoder.height);
  const std::size_t pixel_bytes = wants_color || has_color ? 3 : 1;
  pixels->resize(num_pixels * pixel_bytes);
  if (!decoder.read_rows(pixels->data(), static_cast<std::size_t>(decoder.width) * pixel_bytes)) return decoder.broken(name);
  if (has_color && !wants_color) squeeze_to_gray(pixels, num_pixels);
  return ImageSize{decoder.width, decoder.height};
}

Status decode_png_depth(std::span<const std::uint8_t> bytes, const std::string& name, Image<std::uint16_t>* image) {
  PngDecoder decoder;
  if (!decoder.read_header(bytes)) return decoder.broken(name);
  if (Status status = check_image_size(decoder.width, decoder.height, name); !status) return status;
  if (decoder.bit_depth != 16 || decoder.color_type != PNG_COLOR_TYPE_GRAY) {
    return {ErrorCode::kUnsupported, name + ": " + describe(decoder) + ", expected 16-bit grey depth"};
  }
  if (!decoder.start_depth()) return decoder.broken(name);
  image->resize(decoder.width, decoder.height);
  const std::size_t row_bytes = static_cast<std::size_t>(decoder.width) * sizeof(std::uint16_t);
  if (!decoder.read_rows(reinterpret_cast<std::uint8_t*>(image->pixels.data()), row_bytes)) return decoder.broken(name);
  return Status::ok();
}

}  // namespace camloc
