// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// JPEG to grey or RGB bytes through libjpeg(-turbo). libjpeg repairs broken files with a warning and grey pixels; here
// such a file is an error, since invented pixels would be localized against.
#include <csetjmp>
#include <cstddef>
#include <cstdio>

// jpeglib.h needs size_t and FILE from the lines above.
#include <jerror.h>
#include <jpeglib.h>

#include "core/io/image_file.h"

namespace camloc {

namespace {

/// libjpeg's error manager with a way back. `base` comes first: libjpeg hands out a pointer to it.
struct JpegErrors {
  jpeg_error_mgr base;
  std::jmp_buf way_back;
  char message[JMSG_LENGTH_MAX];
};

JpegErrors* errors_of(j_common_ptr info) { return reinterpret_cast<JpegErrors*>(info->err); }

[[noreturn]] void on_error(j_common_ptr info) {
  info->err->format_message(info, errors_of(info)->message);
  std::longjmp(errors_of(info)->way_back, 1);
}

/// Level -1 is a warning about corrupt data. Stray bytes between markers harm nothing and some cameras write them.
void on_message(j_common_ptr info, int level) {
  if (level < 0 && info->err->msg_code != JWRN_EXTRANEOUS_DATA) on_error(info);
}

void on_output(j_common_ptr) {}

/// A decompressor that is torn down on every way out, its errors included.
struct JpegDecoder {
  jpeg_decompress_struct info{};
  JpegErrors errors{};

  JpegDecoder() {
    info.err = jpeg_std_error(&errors.base);
    errors.base.error_exit = on_error;
    errors.base.emit_message = on_message;
    errors.base.output_message = on_output;
  }
  ~JpegDecoder() { jpeg_destroy_decompress(&info); }
  JpegDecoder(const JpegDecoder&) = delete;
  JpegDecoder& operator=(const JpegDecoder&) = delete;

  // Between setjmp and longjmp of the three steps below no object is constructed.
  bool read_header(std::span<const std::uint8_t> bytes) {
    if (setjmp(errors.way_back) != 0) return false;
    jpeg_create_decompress(&info);
    jpeg_mem_src(&info, bytes.data(), static_cast<unsigned long>(bytes.size()));
    jpeg_read_header(&info, TRUE);
    return true;
  }
  bool start(PixelKind kind) {
    if (setjmp(errors.way_back) != 0) return false;
    info.out_color_space = kind == PixelKind::kGray ? JCS_GRAYSCALE : JCS_RGB;
    info.dct_method = JDCT_ISLOW;  // the one that gives the same bits with and without SIMD
    jpeg_start_decompress(&info);
    return true;
  }
  bool read_rows(std::uint8_t* pixels, std::size_t row_bytes) {
    if (setjmp(errors.way_back) != 0) return false;
    while (info.output_scanline < info.output_height) {
      JSAMPROW row = pixels + info.output_scanline * row_bytes;
      jpeg_read_scanlines(&info, &row, 1);
    }
    jpeg_finish_decompress(&info);
    return true;
  }
  [[nodiscard]] Status broken(const std::string& name) const {
    return {ErrorCode::kCorrupt, name + ": broken JPEG (" + errors.message + ")"};
  }
};

}  // namespace

Result<ImageSize> decode_jpeg(std::span<const std::uint8_t> bytes, const std::string& name, PixelKind kind,
                              std::vector<std::uint8_t>* pixels) {
  JpegDecoder decoder;
  if (!decoder.read_header(bytes)) return decoder.broken(name);
  if (Status status = check_image_size(decoder.info.image_width, decoder.info.image_height, name); !status) return status;
  const ImageSize size{static_cast<int>(decoder.info.image_width), static_cast<int>(decoder.info.image_height)};
  if (pixels == nullptr) return size;
  const J_COLOR_SPACE space = decoder.info.jpeg_color_space;
  if (space != JCS_GRAYSCALE && space != JCS_YCbCr && space != JCS_RGB) {
    return {ErrorCode::kUnsupported,
            name + ": JPEG with " + std::to_string(decoder.info.num_components) + " colour components is not read"};
  }
  if (!decoder.start(kind)) return decoder.broken(name);
  const std::size_t row_bytes = decoder.info.output_width * static_cast<std::size_t>(decoder.info.output_components);
  pixels->resize(row_bytes * decoder.info.output_height);
  if (!decoder.read_rows(pixels->data(), row_bytes)) return decoder.broken(name);
  return size;
}

}  // namespace camloc
