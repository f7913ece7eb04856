// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Pixels as OpenNI2 devices and recordings deliver them, to grey, BGR and raw depth. Pure functions over bytes that are not
// trusted: a size that does not fit is an error, never a read beyond the end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/base/frame.h"
#include "core/base/result.h"

namespace camloc::openni2 {

enum class PixelLayout : std::uint8_t {
  kGray8,    ///< one byte
  kGray16,   ///< infrared, 10 bits in 16; little endian as all that follows
  kRgb24,    ///< red, green, blue
  kUyvy,     ///< U Y0 V Y1 for two pixels, BT.601 of limited range; what OpenNI2 calls YUV422
  kYuyv,     ///< Y0 U Y1 V
  kDepth16,  ///< distance in units that the pixel format names
  kJpeg,     ///< compressed; of recordings only
};

/// An OniPixelFormat: its layout and, for depth, the unit.
struct PixelFormat {
  PixelLayout layout = PixelLayout::kGray8;
  double depth_unit_m = 0;  ///< 0 for what is no depth
  bool operator==(const PixelFormat& other) const = default;
};

/// Empty for formats that are not read: raw shifts (SHIFT_9_2, SHIFT_9_3), which need the device's own table.
[[nodiscard]] std::optional<PixelFormat> pixel_format_of(int oni_pixel_format);
[[nodiscard]] const char* name_of(PixelLayout layout);
/// 0 for kJpeg.
[[nodiscard]] std::size_t bytes_per_pixel(PixelLayout layout);

/// One image in memory of somebody else.
struct RawImage {
  std::span<const std::uint8_t> bytes;
  int width = 0;
  int height = 0;
  std::size_t stride_bytes = 0;  ///< from row to row
  PixelLayout layout = PixelLayout::kGray8;
  bool is_mirrored = false;  ///< left and right are exchanged; the conversions undo it
};

/// kCorrupt where the bytes cannot hold the image. Every conversion below checks it first.
[[nodiscard]] Status check_raw_image(const RawImage& image);
/// BT.601 luma; infrared is cut to its 8 most significant of 10 bits. Not for kJpeg and kDepth16: kUnsupported.
[[nodiscard]] Status to_gray(const RawImage& image, Image<std::uint8_t>* gray);
[[nodiscard]] Status to_bgr(const RawImage& image, Image<Bgr>* color);
/// kDepth16 alone.
[[nodiscard]] Status to_depth(const RawImage& image, Image<std::uint16_t>* depth);

// ---- compressed depth of recordings
//
// The lossless depth compression of .oni recordings, decoding only. The format as we understand it from what OpenNI writes
// (its codecs are named 16zP and 16zT; sources of OpenNI2 2.2, OniFile driver); all numbers little endian unless said:
//
//   16zP  u16 first value, then codes
//   16zT  u16 n, n times u16 value: the table; then as 16zP, but each decoded number is an index into the table
//
// Codes work on the last number, half bytes from the high one:
//   0xE0 + k, k = 0..15      the last number twice, k times
//   0xFF b [c]               one number: b >= 0x80: last - (b - 192); else 256 b + c, big endian
//   otherwise the high half h (0..13): last - (h - 6), then by the low half l:
//     0..12 and 14           last - (l - 6)
//     13                     nothing (padding at the end)
//     15                     one number, in b [c] as above
//
// OpenNI's own decoder follows indices and lengths without asking whether they stay inside, so recordings are decoded here.

enum class OniCodec : std::uint8_t { kNone, k16z, k16zTable, kJpeg };

/// Exactly `depth.size()` numbers from 16zP or 16zT; kCorrupt where the bytes hold more or fewer or point outside their table.
[[nodiscard]] Status decode_depth_codec(OniCodec codec, std::span<const std::uint8_t> bytes, std::span<std::uint16_t> depth);

}  // namespace camloc::openni2
