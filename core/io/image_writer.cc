// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// See image_writer.h. Both libraries encode into memory first, so that their errors and those of the disk stay apart.
#include "core/io/image_writer.h"

#include <png.h>
#include <zlib.h>

#include <bit>
#include <cassert>
#include <cerrno>
#include <csetjmp>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <span>
#include <system_error>
#include <vector>

// jpeglib.h needs size_t and FILE from the lines above.
#include <jpeglib.h>

#include "core/io/file_bytes.h"

namespace camloc {

namespace {

/// A file is replaced as a whole. A device is written to as it is.
Status write_bytes(const std::string& path, const void* data, std::size_t size) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored) || std::filesystem::is_regular_file(path, ignored))
    return replace_file(path, std::span(static_cast<const std::byte*>(data), size), false);
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (file == nullptr) return {ErrorCode::kIo, path + ": " + std::generic_category().message(errno)};
  const bool is_written = std::fwrite(data, 1, size, file) == size;
  const int write_error = errno;
  const bool is_closed = std::fclose(file) == 0;
  if (is_written && is_closed) return Status::ok();
  const int error = is_written ? errno : write_error;
  std::remove(path.c_str());
  return {ErrorCode::kIo, path + ": " + std::generic_category().message(error)};
}

struct PngSink {
  std::vector<std::uint8_t> bytes;
  std::jmp_buf way_back{};
};

[[noreturn]] void on_png_error(png_structp png, png_const_charp) {
  std::longjmp(static_cast<PngSink*>(png_get_error_ptr(png))->way_back, 1);
}
void on_png_warning(png_structp, png_const_charp) {}
void on_png_write(png_structp png, png_bytep data, std::size_t size) {
  auto* sink = static_cast<PngSink*>(png_get_io_ptr(png));
  sink->bytes.insert(sink->bytes.end(), data, data + size);
}
void on_png_flush(png_structp) {}

struct PngLayout {
  int width, height, bit_depth, color_type;
  std::size_t row_bytes;
  PngCompression compression;
};

void set_compression(png_structp png, const PngLayout& layout) {
  const bool is_depth = layout.bit_depth == 16;
  if (layout.compression == PngCompression::kFast || (layout.compression == PngCompression::kSmall && !is_depth)) {
    png_set_compression_level(png, 1);
    png_set_compression_strategy(png, Z_RLE);
    png_set_filter(png, 0, PNG_FILTER_PAETH);
    return;
  }
  const bool is_small = layout.compression == PngCompression::kSmall;
  png_set_compression_level(png, is_small ? 6 : is_depth ? 1 : 3);  // level 9 is 5 % smaller and ten times slower
  // Noise in the low byte of depth defeats every filter; choosing one a row cost 15 of 23 ms a frame.
  if (is_depth) png_set_filter(png, 0, PNG_FILTER_NONE);
}

/// Teardown of the encoder on every way out.
struct PngEncoder {
  png_structp png = nullptr;
  png_infop info = nullptr;
  PngSink sink;

  PngEncoder() = default;
  ~PngEncoder() { png_destroy_write_struct(&png, &info); }
  PngEncoder(const PngEncoder&) = delete;
  PngEncoder& operator=(const PngEncoder&) = delete;

  // Between setjmp and longjmp no object is constructed.
  bool encode(const std::uint8_t* pixels, const PngLayout& layout) {
    if (setjmp(sink.way_back) != 0) return false;
    png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &sink, on_png_error, on_png_warning);
    if (png == nullptr) return false;
    info = png_create_info_struct(png);
    if (info == nullptr) return false;
    png_set_write_fn(png, &sink, on_png_write, on_png_flush);
    set_compression(png, layout);
    png_set_IHDR(png, info, static_cast<png_uint_32>(layout.width), static_cast<png_uint_32>(layout.height), layout.bit_depth,
                 layout.color_type, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_write_info(png, info);
    if constexpr (std::endian::native == std::endian::little) {
      if (layout.bit_depth == 16) png_set_swap(png);
    }
    for (int y = 0; y < layout.height; ++y) png_write_row(png, pixels + static_cast<std::size_t>(y) * layout.row_bytes);
    png_write_end(png, nullptr);
    return true;
  }
};

Status write_png_layout(const std::string& path, const std::uint8_t* pixels, const PngLayout& layout) {
  assert(layout.width > 0 && layout.height > 0);
  PngEncoder encoder;
  if (!encoder.encode(pixels, layout)) return {ErrorCode::kIo, path + ": cannot encode the image"};
  return write_bytes(path, encoder.sink.bytes.data(), encoder.sink.bytes.size());
}

struct JpegErrors {
  jpeg_error_mgr base;
  std::jmp_buf way_back;
};
[[noreturn]] void on_jpeg_error(j_common_ptr info) { std::longjmp(reinterpret_cast<JpegErrors*>(info->err)->way_back, 1); }
void on_jpeg_output(j_common_ptr) {}

/// Teardown of the encoder on every way out.
struct JpegEncoder {
  jpeg_compress_struct info{};
  JpegErrors errors{};
  unsigned char* bytes = nullptr;
  unsigned long size = 0;

  JpegEncoder() = default;
  ~JpegEncoder() {
    jpeg_destroy_compress(&info);
    std::free(bytes);
  }
  JpegEncoder(const JpegEncoder&) = delete;
  JpegEncoder& operator=(const JpegEncoder&) = delete;

  // Between setjmp and longjmp no object is constructed.
  bool encode(const PixelRows& image, int quality) {
    info.err = jpeg_std_error(&errors.base);
    errors.base.error_exit = on_jpeg_error;
    errors.base.output_message = on_jpeg_output;
    if (setjmp(errors.way_back) != 0) return false;
    jpeg_create_compress(&info);
    jpeg_mem_dest(&info, &bytes, &size);
    info.image_width = static_cast<JDIMENSION>(image.width);
    info.image_height = static_cast<JDIMENSION>(image.height);
    info.input_components = image.channels;
    info.in_color_space = image.channels == 3 ? JCS_RGB : JCS_GRAYSCALE;
    jpeg_set_defaults(&info);
    jpeg_set_quality(&info, quality, TRUE);
    jpeg_start_compress(&info, TRUE);
    const std::size_t row_bytes = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.channels);
    while (info.next_scanline < info.image_height) {
      // libjpeg takes rows it does not change through a pointer to non-const.
      JSAMPROW row = const_cast<JSAMPROW>(image.pixels + info.next_scanline * row_bytes);
      jpeg_write_scanlines(&info, &row, 1);
    }
    jpeg_finish_compress(&info);
    return true;
  }
};

}  // namespace

Status write_png(const std::string& path, const PixelRows& image, PngCompression compression) {
  assert(image.channels == 1 || image.channels == 3);
  const int color_type = image.channels == 3 ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_GRAY;
  const std::size_t row_bytes = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.channels);
  return write_png_layout(path, image.pixels, {image.width, image.height, 8, color_type, row_bytes, compression});
}

Status write_depth_png(const std::string& path, const Image<std::uint16_t>& depth, PngCompression compression) {
  const auto* pixels = reinterpret_cast<const std::uint8_t*>(depth.pixels.data());
  return write_png_layout(path, pixels,
                          {depth.width, depth.height, 16, PNG_COLOR_TYPE_GRAY, static_cast<std::size_t>(depth.width) * 2, compression});
}

Status write_jpeg(const std::string& path, const PixelRows& image, int quality) {
  assert(image.channels == 1 || image.channels == 3);
  JpegEncoder encoder;
  if (!encoder.encode(image, quality)) return {ErrorCode::kIo, path + ": cannot encode the image"};
  return write_bytes(path, encoder.bytes, encoder.size);
}

}  // namespace camloc
