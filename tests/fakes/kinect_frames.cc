// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/fakes/kinect_frames.h"

#include <cassert>

namespace camloc::fakes {

std::vector<std::uint8_t> pack_bits(std::span<const std::uint16_t> values, int bits) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve((values.size() * static_cast<std::size_t>(bits) + 7) / 8);
  std::uint32_t pending = 0;
  int num_pending = 0;
  for (const std::uint16_t value : values) {
    pending = pending << bits | (value & ((1U << bits) - 1));
    num_pending += bits;
    while (num_pending >= 8) {
      num_pending -= 8;
      bytes.push_back(static_cast<std::uint8_t>(pending >> num_pending));
    }
  }
  if (num_pending > 0) bytes.push_back(static_cast<std::uint8_t>(pending << (8 - num_pending)));
  return bytes;
}

std::vector<std::uint16_t> unpack_bits(std::span<const std::uint8_t> bytes, int bits) {
  std::vector<std::uint16_t> values;
  values.reserve(bytes.size() * 8 / static_cast<std::size_t>(bits));
  std::uint32_t pending = 0;
  int num_pending = 0;
  for (const std::uint8_t byte : bytes) {
    pending = pending << 8 | byte;
    num_pending += 8;
    if (num_pending < bits) continue;
    num_pending -= bits;
    values.push_back(static_cast<std::uint16_t>(pending >> num_pending & ((1U << bits) - 1)));
  }
  return values;
}

std::vector<std::uint8_t> bayer_mosaic(const ColorImage& image) {
  assert(image.width == kKinectWidth && image.height == kKinectHeight);
  std::vector<std::uint8_t> mosaic(kColorBytes);
  for (int y = 0; y < kKinectHeight; ++y) {
    for (int x = 0; x < kKinectWidth; ++x) {
      const bool is_green = (x + y) % 2 == 0;
      const std::size_t channel = is_green ? 1 : y % 2 == 0 ? 0 : 2;  // rows G R G R and B G B G
      const auto pixel = static_cast<std::size_t>(y) * kKinectWidth + static_cast<std::size_t>(x);
      mosaic[pixel] = image.pixels[3 * pixel + channel];
    }
  }
  return mosaic;
}

std::uint8_t pattern_color(int x, int y, std::uint64_t index) {
  const auto k = static_cast<int>(index % kPatternPeriod);
  return static_cast<std::uint8_t>((x ^ y) + 16 * k);
}

std::uint16_t pattern_disparity(int x, int y, std::uint64_t index) {
  const auto k = static_cast<int>(index % kPatternPeriod);
  return static_cast<std::uint16_t>((x + 3 * y + 37 * k) & 0x7ff);
}

namespace {

std::vector<std::uint8_t> color_pattern(std::uint64_t index) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(kColorBytes);
  for (int y = 0; y < kKinectHeight; ++y)
    for (int x = 0; x < kKinectWidth; ++x) bytes.push_back(pattern_color(x, y, index));
  return bytes;
}

std::vector<std::uint8_t> depth_pattern(std::uint64_t index, int bits) {
  std::vector<std::uint16_t> values;
  values.reserve(kColorBytes);
  for (int y = 0; y < kKinectHeight; ++y)
    for (int x = 0; x < kKinectWidth; ++x) values.push_back(static_cast<std::uint16_t>(pattern_disparity(x, y, index) >> (11 - bits)));
  return pack_bits(values, bits);
}

std::vector<std::uint8_t> plain_pattern(std::size_t size, std::uint64_t index) {
  std::vector<std::uint8_t> bytes(size);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::uint8_t>(i * 31 + i / 251 + 7 * (index % kPatternPeriod));
  return bytes;
}

}  // namespace

std::span<const std::uint8_t> PatternShow::frame(FrameFormat format, std::uint64_t index) {
  std::vector<std::uint8_t>& bytes = frames_[{format, index % kPatternPeriod}];
  if (!bytes.empty()) return bytes;
  switch (format) {
    case FrameFormat::kBayer: bytes = color_pattern(index); break;
    case FrameFormat::kDepth11: bytes = depth_pattern(index, 11); break;
    case FrameFormat::kDepth10: bytes = depth_pattern(index, 10); break;
    default: bytes = plain_pattern(payload_bytes(format), index); break;
  }
  return bytes;
}

}  // namespace camloc::fakes
