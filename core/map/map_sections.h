// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// From the bytes of a .cmap file to typed arrays, and the checks that make them safe to use. Knows no file and no
// mapping: everything here works on bytes in memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/result.h"
#include "core/features/descriptor.h"
#include "core/map/map_format.h"

namespace camloc {

/// Looks into the bytes it was made from.
struct MapSections {
  map_format::FileHeader header{};  ///< a copy
  map_format::MetaRecord meta{};    ///< a copy
  std::span<const map_format::CubeRecord> cubes;
  std::span<const map_format::LandmarkRecord> landmarks;
  std::span<const Descriptor> descriptors;
  std::span<const map_format::KeyframeRecord> keyframes;
  std::span<const std::uint8_t> keyframe_lists;
  std::span<const Descriptor> words;
  std::span<const std::uint32_t> word_begin;
  std::span<const std::uint16_t> inverted_keyframes;
  std::span<const std::uint8_t> inverted_weights;
  std::span<const map_format::WcsRecord> wcs;
};

/// Hash of the format: XXH3 64-bit.
[[nodiscard]] std::uint64_t map_hash(std::span<const std::byte> bytes);

/// Header, section table, bounds and hashes. `bytes` must start at a multiple of 64.
/// Errors: kCorrupt (not a map, truncated, damaged), kUnsupported (another version or byte order).
[[nodiscard]] Result<MapSections> read_map_sections(std::span<const std::byte> bytes);

/// Every value that will be used as an index, a count or a factor. kCorrupt names the first that is wrong.
[[nodiscard]] Status check_map_content(const MapSections& map);

}  // namespace camloc
