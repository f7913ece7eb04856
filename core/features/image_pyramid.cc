// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/image_pyramid.h"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>

#include "core/base/avx2.h"

namespace camloc {
namespace {

/// Taps of one axis. The scale is the reciprocal of a reciprocal and weights are rounded half to even, as in OpenCV.
std::vector<ResizeTap> make_taps(int src_size, int dst_size) {
  std::vector<ResizeTap> taps(static_cast<std::size_t>(dst_size));
  const double scale = 1.0 / (static_cast<double>(dst_size) / src_size);
  for (int i = 0; i < dst_size; ++i) {
    const double position = scale * (i + 0.5) - 0.5;
    const int offset = static_cast<int>(std::floor(position));
    ResizeTap& tap = taps[static_cast<std::size_t>(i)];
    if (offset < 0) {
      tap = {0, 0};
    } else if (offset >= src_size - 1) {
      tap = {src_size - 1, 0};
    } else {
      tap = {offset, static_cast<std::uint16_t>(std::nearbyint((position - offset) * 256))};
    }
  }
  return taps;
}

void resize_row(const std::uint8_t* src, const std::vector<ResizeTap>& taps, std::uint16_t* dst) {
  for (const ResizeTap& tap : taps) {
    // Where the weight is 0 the second pixel may lie after the last one; rows are padded.
    const std::uint8_t* pixel = src + tap.offset;
    *dst++ = static_cast<std::uint16_t>(pixel[0] * (256 - tap.weight) + pixel[1] * tap.weight);
  }
}

void mix_rows(const std::uint16_t* first, const std::uint16_t* second, std::uint32_t weight, int width, std::uint8_t* dst) {
  for (int x = 0; x < width; ++x) dst[x] = static_cast<std::uint8_t>((first[x] * (256 - weight) + second[x] * weight + 32768) >> 16);
}

#if defined(__x86_64__)
/// Empty when eight columns reach over more than 16 source pixels (scale factors above two).
std::vector<ResizeBlock> make_blocks(const std::vector<ResizeTap>& taps) {
  std::vector<ResizeBlock> blocks((taps.size() + 15) / 16);
  for (std::size_t i = 0; i < blocks.size() * 16; ++i) {
    const ResizeTap& tap = taps[std::min(i, taps.size() - 1)];
    ResizeBlock& block = blocks[i / 16];
    std::int32_t& base = block.offset[i % 16 / 8];
    if (i % 8 == 0) base = tap.offset;
    if (tap.offset + 1 - base > 15) return {};
    block.shuffle[i % 16 * 2] = static_cast<std::uint8_t>(tap.offset - base);
    block.shuffle[i % 16 * 2 + 1] = static_cast<std::uint8_t>(tap.offset + 1 - base);
    block.weight[i % 16] = tap.weight;
  }
  return blocks;
}

/// Writes whole blocks: up to 15 columns more than there are.
CAMLOC_AVX2 void resize_row_avx2(const std::uint8_t* src, const ResizeBlock* blocks, std::size_t num_blocks, std::uint16_t* dst) {
  for (std::size_t i = 0; i < num_blocks; ++i, dst += 16) {
    const ResizeBlock& block = blocks[i];
    const __m128i low = _mm_loadu_si128(reinterpret_cast<const __m128i*>(src + block.offset[0]));
    const __m128i high = _mm_loadu_si128(reinterpret_cast<const __m128i*>(src + block.offset[1]));
    const __m256i shuffle = _mm256_load_si256(reinterpret_cast<const __m256i*>(block.shuffle));
    const __m256i weight = _mm256_load_si256(reinterpret_cast<const __m256i*>(block.weight));
    const __m256i pairs = _mm256_shuffle_epi8(_mm256_inserti128_si256(_mm256_castsi128_si256(low), high, 1), shuffle);
    const __m256i first = _mm256_and_si256(pairs, _mm256_set1_epi16(255)), second = _mm256_srli_epi16(pairs, 8);
    // 256 first + (second - first) weight, modulo 2^16, which the result is below.
    const __m256i change = _mm256_mullo_epi16(_mm256_sub_epi16(second, first), weight);
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(dst), _mm256_add_epi16(_mm256_slli_epi16(first, 8), change));
  }
}

/// Sixteen pixels as 16-bit lanes. Rows are made signed for the multiplication; the offset comes back with the rounding.
CAMLOC_AVX2 CAMLOC_INLINE __m256i mix_sixteen(const std::uint16_t* first, const std::uint16_t* second, __m256i weights) {
  const __m256i sign = _mm256_set1_epi16(-32768), rounding = _mm256_set1_epi32(256 * 32768 + 32768);
  const __m256i a = _mm256_xor_si256(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(first)), sign);
  const __m256i b = _mm256_xor_si256(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(second)), sign);
  const __m256i low = _mm256_add_epi32(_mm256_madd_epi16(_mm256_unpacklo_epi16(a, b), weights), rounding);
  const __m256i high = _mm256_add_epi32(_mm256_madd_epi16(_mm256_unpackhi_epi16(a, b), weights), rounding);
  return _mm256_packus_epi32(_mm256_srli_epi32(low, 16), _mm256_srli_epi32(high, 16));
}

/// Reads and writes up to 31 columns more than `width`; rows are padded.
CAMLOC_AVX2 void mix_rows_avx2(const std::uint16_t* first, const std::uint16_t* second, std::uint32_t weight, int width,
                               std::uint8_t* dst) {
  const __m256i weights = _mm256_set1_epi32(static_cast<int>(weight << 16 | (256 - weight)));
  for (int x = 0; x < width; x += 32) {
    const __m256i low = mix_sixteen(first + x, second + x, weights), high = mix_sixteen(first + x + 16, second + x + 16, weights);
    const __m256i bytes = _mm256_permute4x64_epi64(_mm256_packus_epi16(low, high), 0xd8);
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(dst + x), bytes);
  }
}
#endif

}  // namespace

void PaddedImage::allocate(int new_width, int new_height) {
  width = new_width;
  height = new_height;
  stride = (new_width + kPadding + 63) / 64 * 64;
  pixels.assign(static_cast<std::size_t>(stride) * static_cast<std::size_t>(new_height) + kPadding, 0);
}

ExactResize::ExactResize(int src_width, int src_height, int dst_width, int dst_height)
    : columns_(make_taps(src_width, dst_width)), rows_(make_taps(src_height, dst_height)) {
  for (auto& buffer : row_buffer_) buffer.resize(static_cast<std::size_t>(dst_width + PaddedImage::kPadding));
#if defined(__x86_64__)
  if (has_avx2()) blocks_ = make_blocks(columns_);
#endif
}

void ExactResize::apply(const PaddedImage& src, PaddedImage* dst) {
  int row_in_buffer[2] = {-1, -1};
  const auto resized_row = [&](int y) {
    const int slot = y & 1;
    std::uint16_t* row = row_buffer_[slot].data();
    if (row_in_buffer[slot] == y) return row;
    row_in_buffer[slot] = y;
#if defined(__x86_64__)
    if (!blocks_.empty()) {
      resize_row_avx2(src.row(y), blocks_.data(), blocks_.size(), row);
      return row;
    }
#endif
    resize_row(src.row(y), columns_, row);
    return row;
  };
  for (int y = 0; y < dst->height; ++y) {
    const ResizeTap tap = rows_[static_cast<std::size_t>(y)];
    const std::uint16_t* first = resized_row(tap.offset);
    const std::uint16_t* second = tap.weight > 0 ? resized_row(tap.offset + 1) : first;
#if defined(__x86_64__)
    if (!blocks_.empty()) {
      mix_rows_avx2(first, second, tap.weight, dst->width, dst->row(y));
      continue;
    }
#endif
    mix_rows(first, second, tap.weight, dst->width, dst->row(y));
  }
}

ImagePyramid::ImagePyramid(int width, int height, int num_levels, float scale_factor) {
  assert(width > 0 && height > 0 && num_levels > 0 && scale_factor > 1);
  for (int level = 0; level < num_levels; ++level) {
    const auto scale = static_cast<float>(std::pow(static_cast<double>(scale_factor), level));
    const int level_width = static_cast<int>(std::lrint(static_cast<float>(width) / scale));
    const int level_height = static_cast<int>(std::lrint(static_cast<float>(height) / scale));
    if (level_width < 1 || level_height < 1) break;
    levels_.emplace_back().allocate(level_width, level_height);
    if (level > 0) {
      const PaddedImage& previous = levels_[levels_.size() - 2];
      resizes_.emplace_back(previous.width, previous.height, level_width, level_height);
    }
  }
}

void ImagePyramid::build(ImageView<std::uint8_t> image) {
  PaddedImage& base = levels_[0];
  assert(image.width == base.width && image.height == base.height);
  for (int y = 0; y < base.height; ++y) std::memcpy(base.row(y), image.row(y), static_cast<std::size_t>(base.width));
  for (std::size_t i = 0; i < resizes_.size(); ++i) resizes_[i].apply(levels_[i], &levels_[i + 1]);
}

}  // namespace camloc
