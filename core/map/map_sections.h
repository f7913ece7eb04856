// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// From the bytes of a .cmap file to typed arrays, and the checks that make them safe to use. Knows no file and no
// mapping: everything here works on bytes in memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/features/descriptor.h"
#include "core/map/map_format.h"

namespace camloc {

struct MapSections;

/// A line of the table of sections that a reader knows.
struct SectionKind {
  map_format::SectionId id;
  const char* name;
  std::uint16_t element_bytes;
  /// Every value of it that will be used as an index, a count or a factor; called where the map has the section, after all
  /// sizes and hashes. kCorrupt names the first that is wrong. Null: nothing to check, or checked with another section.
  Status (*check)(const MapSections& map);
};

/// The table of this camloc; see section_table.cc.
[[nodiscard]] std::span<const SectionKind> known_sections();

/// A section as it lies in the file.
struct MapSection {
  map_format::SectionRecord record{};
  const SectionKind* kind = nullptr;  ///< null: not known here, skipped
  std::string name;                   ///< of a section that is not known: its four characters, or its number
  std::span<const std::byte> bytes;   ///< begin at a multiple of 64; whole elements
};

/// Looks into the bytes it was made from.
struct MapSections {
  std::vector<MapSection> sections;  ///< all, in the order of the file
  /// The bytes of one; empty where the map does not have it.
  [[nodiscard]] std::span<const std::byte> section(map_format::SectionId id) const;

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

/// Header, section table, bounds and hashes, for a reader that knows `known` (which has the core sections, and outlives
/// what is returned). `bytes` must start at a multiple of 64.
/// Errors: kCorrupt (not a map, truncated, damaged), kUnsupported (another version or byte order, a section that must be
/// understood and is not known).
[[nodiscard]] Result<MapSections> read_map_sections(std::span<const std::byte> bytes,
                                                    std::span<const SectionKind> known = known_sections());

/// The content of the sections that are known.
[[nodiscard]] Status check_map_content(const MapSections& map);

}  // namespace camloc
