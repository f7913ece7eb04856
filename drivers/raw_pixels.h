// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Pixels as sensors and decoders give them: packed without gaps, RGB, and Bayer mosaics, 8 bits a pixel, to grey and to colour by
// bilinear interpolation. Grey does not go by way of colour: every grey value is a weighted sum of the 3x3 pixels around it, which
// is what the frame path can afford.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/frame.h"

namespace camloc {

/// Colours of the first two pixels of the first and of the second row.
enum class BayerOrder : std::uint8_t { kRggb, kGrbg, kGbrg, kBggr };

/// Luma of the bilinear interpolation: (19 R + 38 G + 7 B) / 64, rounded, ITU-R BT.601 weights in steps of 1/64, so that a plain
/// surface has one grey on all four kinds of pixel. Beyond the border the mosaic is mirrored (row -1 is row 1). `mosaic` is at
/// least 2x2 pixels; `gray` is resized to it.
void bayer_to_gray(const ImageView<std::uint8_t>& mosaic, BayerOrder order, Image<std::uint8_t>* gray);

/// The bilinear interpolation itself: a colour that a pixel lacks is the rounded mean of its two or four nearest pixels of
/// that colour. Border and sizes as above.
void bayer_to_bgr(const ImageView<std::uint8_t>& mosaic, BayerOrder order, Image<Bgr>* color);

/// Bytes that `num_pixels` pixels of `bits` bits take.
[[nodiscard]] constexpr std::size_t packed_bytes(std::size_t num_pixels, unsigned bits) { return (num_pixels * bits + 7) / 8; }

/// Of pixels packed without gaps, the first in the highest bits of the first byte: what the Kinect sends as infrared and depth
/// (OpenKinect, "Protocol Documentation") and V4L2 calls Y10B. Unpacks `num_pixels` pixels of `bits` bits (1 to 16) from
/// packed_bytes(num_pixels, bits) bytes. Nothing behind them is read.
void unpack_pixels(const std::uint8_t* packed, std::size_t num_pixels, unsigned bits, std::uint16_t* pixels);

/// Red, green, blue bytes of all pixels of `color`, which has its size.
void rgb_to_bgr(std::span<const std::uint8_t> rgb, Image<Bgr>* color);

}  // namespace camloc
