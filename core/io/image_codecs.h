// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The two decoders behind image_file.h, for its use only. Neither library's error exit (longjmp) leaves these functions,
// and no object with a destructor lives inside their reach.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/base/frame.h"
#include "core/base/result.h"
#include "core/io/image_file.h"

namespace camloc {

enum class PixelKind { kGray, kColor };

[[nodiscard]] Status check_image_size(std::int64_t width, std::int64_t height, const std::string& name);

/// Bytes in rows without gaps, one a pixel for kGray, three for kColor.
struct ByteImage {
  std::vector<std::uint8_t>* pixels = nullptr;
  int width = 0;
  int height = 0;
};

[[nodiscard]] Status decode_jpeg(std::span<const std::uint8_t> bytes, const std::string& name, PixelKind kind, ByteImage* image);
[[nodiscard]] Result<ImageSize> decode_jpeg_size(std::span<const std::uint8_t> bytes, const std::string& name);
[[nodiscard]] Status decode_png(std::span<const std::uint8_t> bytes, const std::string& name, PixelKind kind, ByteImage* image);
[[nodiscard]] Status decode_png_depth(std::span<const std::uint8_t> bytes, const std::string& name, Image<std::uint16_t>* image);
[[nodiscard]] Result<ImageSize> decode_png_size(std::span<const std::uint8_t> bytes, const std::string& name);

}  // namespace camloc
