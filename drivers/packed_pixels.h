// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Pixels of 10 or 11 bits packed without gaps, the first pixel in the highest bits of the first byte: what the Kinect sends as
// infrared and depth (OpenKinect, "Protocol Documentation") and V4L2 calls Y10B.
#pragma once

#include <cstddef>
#include <cstdint>

namespace camloc {

/// Bytes that `num_pixels` pixels of `bits` bits take.
[[nodiscard]] constexpr std::size_t packed_bytes(std::size_t num_pixels, unsigned bits) { return (num_pixels * bits + 7) / 8; }

/// Unpacks `num_pixels` pixels of `bits` bits (1 to 16) from packed_bytes(num_pixels, bits) bytes. Nothing behind them is read.
void unpack_pixels(const std::uint8_t* packed, std::size_t num_pixels, unsigned bits, std::uint16_t* pixels);

}  // namespace camloc
