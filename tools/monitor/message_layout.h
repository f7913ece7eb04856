// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Whether bytes from the network are laid out as a message of the daemon. The decoders that lcm-gen 1.3.1 writes believe the length of
// a string: 0 becomes an exception and a negative one a read far outside. What does not pass here never reaches them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "camloc/pose_t.hpp"
#include "camloc/status_t.hpp"

namespace camloc::tools {

/// Bytes of fixed length before each string of a message, and after the last one.
inline constexpr std::size_t kPoseLayout[] = {8 + 3 * 8, 0, (3 + 4 + 36) * 8 + 3 + 8 + 2 * 8 + 2 * 8, 4 * 4 + 8 + 6 * 4 + 4};
inline constexpr std::size_t kStatusLayout[] = {8 + 8 + 1, 0, 0, 10 * 8, 4 * 8 + 8 + 3 * 8 + 4 * 8 + 8 + 1 + 8};

/// Strings are their length with the closing zero, 32 bits in network order, then the characters. Nothing may be left over.
[[nodiscard]] inline bool has_layout(std::span<const std::uint8_t> bytes, std::span<const std::size_t> layout) {
  for (std::size_t i = 0; i < layout.size(); ++i) {
    if (bytes.size() < layout[i]) return false;
    bytes = bytes.subspan(layout[i]);
    if (i + 1 == layout.size()) break;
    if (bytes.size() < 4) return false;
    std::uint32_t length = 0;
    for (std::size_t k = 0; k < 4; ++k) length = length << 8U | bytes[k];
    bytes = bytes.subspan(4);
    if (length == 0 || length > bytes.size()) return false;
    bytes = bytes.subspan(length);
  }
  return bytes.empty();
}

/// decode() of what passed: false for anything else, also for another type.
template <typename Message>
[[nodiscard]] bool decode_message(std::span<const std::uint8_t> bytes, std::span<const std::size_t> layout, Message* message) {
  constexpr std::size_t kMaxBytes = 1 << 16;  // of a datagram
  if (bytes.size() > kMaxBytes || !has_layout(bytes, layout)) return false;
  return message->decode(bytes.data(), 0, static_cast<int>(bytes.size())) == static_cast<int>(bytes.size());
}

}  // namespace camloc::tools
