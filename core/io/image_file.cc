// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The first bytes tell JPEG from PNG; the decoders are in jpeg_decoder.cc and png_decoder.cc. They ask
// check_image_size() before anything is allocated.
#include "core/io/image_file.h"

#include <algorithm>
#include <array>

#include "core/io/file_bytes.h"

namespace camloc {

namespace {

constexpr std::array<std::uint8_t, 3> kJpegMagic{0xFF, 0xD8, 0xFF};
constexpr std::array<std::uint8_t, 8> kPngMagic{0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};

template <std::size_t N>
bool starts_with(std::span<const std::uint8_t> bytes, const std::array<std::uint8_t, N>& magic) {
  return bytes.size() >= N && std::equal(magic.begin(), magic.end(), bytes.begin());
}

Status unknown_kind(std::span<const std::uint8_t> bytes, const std::string& name) {
  if (bytes.empty()) return {ErrorCode::kCorrupt, name + ": the file is empty"};
  return {ErrorCode::kCorrupt, name + ": neither a JPEG nor a PNG image"};
}

/// Without `pixels` only the header is read.
Result<ImageSize> decode_bytes(std::span<const std::uint8_t> bytes, const std::string& name, PixelKind kind,
                               std::vector<std::uint8_t>* pixels) {
  if (starts_with(bytes, kJpegMagic)) return decode_jpeg(bytes, name, kind, pixels);
  if (starts_with(bytes, kPngMagic)) return decode_png(bytes, name, kind, pixels);
  return unknown_kind(bytes, name);
}

/// `AnyImage` has pixels, width and height.
template <typename AnyImage>
Status decode_into(std::span<const std::uint8_t> bytes, const std::string& name, PixelKind kind, AnyImage* image) {
  const Result<ImageSize> size = decode_bytes(bytes, name, kind, &image->pixels);
  if (!size) return size.status();
  image->width = size->width;
  image->height = size->height;
  return Status::ok();
}

/// As much of the file as an image of its size can fill; what is behind (a film, another file) is not looked at.
Status read_image_bytes(const std::string& path, std::vector<std::uint8_t>* bytes) {
  constexpr std::size_t kHead = 1 << 20;        // holds the size, and all of most images
  constexpr std::size_t kMaxBytesOfPixel = 10;  // four channels of 16 bits that no codec makes smaller, and its overhead
  if (Status status = read_file_prefix(path, kHead, bytes); !status || bytes->size() < kHead) return status;
  const Result<ImageSize> size = decode_bytes(*bytes, path, PixelKind::kGray, nullptr);
  if (!size) return size.status();
  const std::size_t num_pixels = static_cast<std::size_t>(size->width) * static_cast<std::size_t>(size->height);
  return read_file_prefix(path, std::min(kMaxImageFileBytes, kHead + kMaxBytesOfPixel * num_pixels), bytes);
}

}  // namespace

Status check_image_size(std::int64_t width, std::int64_t height, const std::string& name) {
  const bool is_fine = width > 0 && height > 0 && width <= kMaxImageSide && height <= kMaxImageSide && width * height <= kMaxImagePixels;
  if (is_fine) return Status::ok();
  return {ErrorCode::kUnsupported, name + ": image of " + std::to_string(width) + "x" + std::to_string(height) + " pixels is out of range"};
}

Status decode_gray(std::span<const std::uint8_t> bytes, const std::string& name, Image<std::uint8_t>* image) {
  return decode_into(bytes, name, PixelKind::kGray, image);
}

Status decode_depth(std::span<const std::uint8_t> bytes, const std::string& name, Image<std::uint16_t>* image) {
  if (starts_with(bytes, kPngMagic)) return decode_png_depth(bytes, name, image);
  if (starts_with(bytes, kJpegMagic))
    return {ErrorCode::kUnsupported, name + ": a JPEG image cannot hold depth; expected a 16-bit grey PNG"};
  return unknown_kind(bytes, name);
}

Result<ColorImage> decode_color(std::span<const std::uint8_t> bytes, const std::string& name) {
  ColorImage image;
  if (Status status = decode_into(bytes, name, PixelKind::kColor, &image); !status) return status;
  return image;
}

Result<ImageSize> decode_image_size(std::span<const std::uint8_t> bytes, const std::string& name) {
  return decode_bytes(bytes, name, PixelKind::kGray, nullptr);
}

Status ImageReader::read_gray(const std::string& path, Image<std::uint8_t>* image) {
  Status status = read_image_bytes(path, &bytes_);
  return status ? decode_gray(bytes_, path, image) : status;
}

Status ImageReader::read_depth(const std::string& path, Image<std::uint16_t>* image) {
  Status status = read_image_bytes(path, &bytes_);
  return status ? decode_depth(bytes_, path, image) : status;
}

Result<ColorImage> ImageReader::read_color(const std::string& path) {
  if (Status status = read_image_bytes(path, &bytes_); !status) return status;
  return decode_color(bytes_, path);
}

Result<ImageSize> ImageReader::read_size(const std::string& path) {
  if (Status status = read_image_bytes(path, &bytes_); !status) return status;
  return decode_image_size(bytes_, path);
}

}  // namespace camloc
