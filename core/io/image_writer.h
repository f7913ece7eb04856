// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Writes PNG and JPEG files for tools and tests. Reading is in image_file.h.
#pragma once

#include <cstdint>
#include <string>

#include "core/base/frame.h"
#include "core/base/result.h"
#include "core/io/image_file.h"

namespace camloc {

/// How long a PNG may take. Times and sizes: 640x480 of a Kinect V1, one core of a shared x86-64 server. For camera images a run
/// length coder behind the Paeth filter is both faster and smaller than a search for repetitions.
enum class PngCompression : std::uint8_t {
  kPicture,  ///< for drawings; grey 13 ms, 146 kB; depth 5 ms, 110 kB
  kFast,     ///< for cameras; grey 5 ms, 129 kB; colour 14 ms, 384 kB; depth 6 ms, 96 kB
  kSmall,    ///< for archives; images as kFast; depth 19 ms, 73 kB
};

/// Rows of width * channels bytes without gaps, owned by somebody else; channels 1 (grey) or 3 (red, green, blue).
struct PixelRows {
  const std::uint8_t* pixels = nullptr;
  int width = 0, height = 0, channels = 0;

  PixelRows(const std::uint8_t* data, int columns, int rows, int depth) : pixels(data), width(columns), height(rows), channels(depth) {}
  PixelRows(const Image<std::uint8_t>& gray)  // NOLINT(google-explicit-constructor)
      : PixelRows(gray.pixels.data(), gray.width, gray.height, 1) {}
  PixelRows(const ColorImage& color)  // NOLINT(google-explicit-constructor)
      : PixelRows(color.pixels.data(), color.width, color.height, 3) {}
};

/// kIo names the file and the reason; a file that could not be written whole is removed.
[[nodiscard]] Status write_png(const std::string& path, const PixelRows& image, PngCompression compression = PngCompression::kPicture);
/// 16-bit grey, the raw units of a depth camera.
[[nodiscard]] Status write_depth_png(const std::string& path, const Image<std::uint16_t>& depth,
                                     PngCompression compression = PngCompression::kPicture);
/// As write_png; quality 1 to 100.
[[nodiscard]] Status write_jpeg(const std::string& path, const PixelRows& image, int quality = 95);

}  // namespace camloc
