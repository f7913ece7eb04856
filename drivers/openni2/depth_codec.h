// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
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
#pragma once

#include <cstdint>
#include <span>

#include "core/base/result.h"

namespace camloc::openni2 {

enum class DepthCodec : std::uint8_t { k16z, k16zTable };

/// Exactly `depth.size()` numbers; kCorrupt where the bytes hold more or fewer or point outside their table.
[[nodiscard]] Status decode_depth_codec(DepthCodec codec, std::span<const std::uint8_t> bytes, std::span<std::uint16_t> depth);

}  // namespace camloc::openni2
