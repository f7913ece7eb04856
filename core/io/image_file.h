// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Decodes the images of recordings with libjpeg and libpng alone: OpenCV's imgcodecs would cost the daemon 50 MB. JPEG
// goes straight to grey, its chroma is never transformed. Writing is in image_writer.h.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/base/frame.h"
#include "core/base/result.h"

namespace camloc {

/// Larger images are refused before anything is allocated for them.
inline constexpr int kMaxImageSide = 16384;
inline constexpr std::int64_t kMaxImagePixels = 32 << 20;
inline constexpr std::size_t kMaxImageFileBytes = std::size_t{256} << 20;

/// Red, green, blue bytes in rows without gaps.
struct ColorImage {
  std::vector<std::uint8_t> pixels;
  int width = 0;
  int height = 0;
};

struct ImageSize {
  int width = 0;
  int height = 0;
};

/// Grey from a JPEG or an 8-bit PNG (grey, palette, RGB, with or without alpha, which is ignored); ITU-R BT.601 weights.
/// `name` is for messages. kCorrupt: broken or truncated; kUnsupported: another kind or bit depth. On an error the pixels
/// of `image` are unspecified.
[[nodiscard]] Status decode_gray(std::span<const std::uint8_t> bytes, const std::string& name, Image<std::uint8_t>* image);
/// Raw depth units from a 16-bit grey PNG; errors as above.
[[nodiscard]] Status decode_depth(std::span<const std::uint8_t> bytes, const std::string& name, Image<std::uint16_t>* image);
/// The same kinds as decode_gray, in colour.
[[nodiscard]] Result<ColorImage> decode_color(std::span<const std::uint8_t> bytes, const std::string& name);
/// From the header alone.
[[nodiscard]] Result<ImageSize> decode_image_size(std::span<const std::uint8_t> bytes, const std::string& name);

/// The same from files; the file's bytes go through a buffer that is reused from image to image. Not thread-safe.
class ImageReader {
 public:
  [[nodiscard]] Status read_gray(const std::string& path, Image<std::uint8_t>* image);
  [[nodiscard]] Status read_depth(const std::string& path, Image<std::uint16_t>* image);
  [[nodiscard]] Result<ColorImage> read_color(const std::string& path);
  [[nodiscard]] Result<ImageSize> read_size(const std::string& path);

 private:
  std::vector<std::uint8_t> bytes_;
};

// What the functions above are made of, for cameras that deliver such bytes. Neither library's error exit (longjmp) leaves these functions,
// and no object with a destructor lives inside their reach.
enum class PixelKind { kGray, kColor };

[[nodiscard]] Status check_image_size(std::int64_t width, std::int64_t height, const std::string& name);

/// Into bytes in rows without gaps, one a pixel for kGray, three for kColor. Without `pixels` only the header is read.
[[nodiscard]] Result<ImageSize> decode_jpeg(std::span<const std::uint8_t> bytes, const std::string& name, PixelKind kind,
                                            std::vector<std::uint8_t>* pixels);
[[nodiscard]] Result<ImageSize> decode_png(std::span<const std::uint8_t> bytes, const std::string& name, PixelKind kind,
                                           std::vector<std::uint8_t>* pixels);
[[nodiscard]] Status decode_png_depth(std::span<const std::uint8_t> bytes, const std::string& name, Image<std::uint16_t>* image);

}  // namespace camloc
