// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The structure of the file: header, then the table entry by entry, each with its place, size and hash, then the typed
// arrays. What the content means is checked by the functions of section_table.cc. The reasons given here get the path and
// the advice in front and behind by MapView::open.
#include "core/map/map_sections.h"

#include <xxhash.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <string>

#include "core/base/checked.h"

namespace camloc {
namespace {

using map_format::FileHeader;
using map_format::SectionId;
using map_format::SectionRecord;

/// Tables are indexed with 32 bits.
constexpr std::uint64_t kMaxElements = std::numeric_limits<std::uint32_t>::max() - 1;

Status corrupt(std::string reason) { return {ErrorCode::kCorrupt, std::move(reason)}; }
Status unsupported(std::string reason) { return {ErrorCode::kUnsupported, std::move(reason)}; }

Result<FileHeader> read_header(std::span<const std::byte> bytes) {
  FileHeader header;
  if (bytes.size() < sizeof header.magic) return corrupt("the file is too short to be a map");
  std::memcpy(&header.magic, bytes.data(), sizeof header.magic);
  if (header.magic != map_format::kMagic) return corrupt("the file does not begin like a camloc map");
  if (bytes.size() < sizeof header) return corrupt("the file is truncated in its header");
  std::memcpy(&header, bytes.data(), sizeof header);
  if (header.byte_order == map_format::kOtherByteOrder) return unsupported("made on a machine of the other byte order");
  const std::uint64_t hash = map_hash(bytes.first(offsetof(FileHeader, header_hash)));
  if (header.header_hash != hash || header.byte_order != map_format::kByteOrder) return corrupt("the header is damaged");
  if (header.version > map_format::kVersion) {
    return unsupported("made by a newer camloc (format " + std::to_string(header.version) + ", this one reads up to " +
                       std::to_string(map_format::kVersion) + ")");
  }
  if (header.version < map_format::kOldestVersion) return unsupported("format " + std::to_string(header.version) + " is no longer read");
  if (header.file_bytes > bytes.size()) {
    return corrupt("the file is truncated: " + std::to_string(bytes.size()) + " of " + std::to_string(header.file_bytes) + " bytes");
  }
  if (header.file_bytes < bytes.size()) return corrupt("the file is longer than its header says");
  const std::uint32_t max_sections = header.version == 1 ? map_format::kNumCoreSections : map_format::kMaxSections;
  if (header.num_sections < map_format::kNumCoreSections || header.num_sections > max_sections) return corrupt("wrong section table");
  const std::uint64_t table_end = map_format::first_section_offset(header.num_sections);
  if (bytes.size() < table_end || header.map_id != map_hash(bytes.subspan(sizeof header, table_end - sizeof header))) {
    return corrupt("the section table is damaged");
  }
  return header;
}

std::string name_of(const SectionKind* kind, SectionId id) {
  if (kind != nullptr) return kind->name;
  std::string name;
  for (auto rest = static_cast<std::uint32_t>(id); name.size() < 4; rest >>= 8) {
    const auto character = static_cast<char>(rest & 0xFFU);
    if (character < ' ' || character > '~') return std::to_string(static_cast<std::uint32_t>(id));
    name += character;
  }
  return name;
}

/// Is the section what this reader thinks it is, or one that it may skip?
Status check_understood(const SectionRecord& record, const SectionKind* kind, const std::string& name, std::uint16_t known_flags) {
  if ((record.flags & ~known_flags) != 0) return unsupported("section " + name + " has flags that this camloc does not know");
  if (kind == nullptr && (record.flags & map_format::kSectionIsOptional) == 0) {
    return unsupported("section " + name + " must be understood and this camloc does not know it");
  }
  if (record.element_bytes == 0 || (kind != nullptr && record.element_bytes != kind->element_bytes)) {
    return corrupt("wrong size of the elements of section " + name);
  }
  return Status::ok();
}

/// The bytes of a section that must begin at `*offset`, which moves to where the next one begins.
Result<std::span<const std::byte>> section_bytes(std::span<const std::byte> file, const SectionRecord& record, const std::string& name,
                                                 std::uint64_t* offset) {
  if (record.offset != *offset || record.num_elements > kMaxElements) return corrupt("wrong table entry of section " + name);
  const auto end = checked_end(record.offset, record.num_elements, record.element_bytes);
  const auto padded_end = end ? checked_align_up(*end, map_format::kAlignment) : std::nullopt;
  if (!padded_end || *padded_end > file.size()) return corrupt("section " + name + " does not fit into the file");
  if (map_hash(file.subspan(record.offset, *padded_end - record.offset)) != record.hash) {
    return corrupt("checksum of section " + name + " does not match");
  }
  *offset = *padded_end;
  return file.subspan(record.offset, *end - record.offset);
}

/// Every entry of the table.
Result<std::vector<MapSection>> read_table(std::span<const std::byte> file, const FileHeader& header, std::span<const SectionKind> known) {
  const std::uint16_t known_flags = header.version == 1 ? 0 : map_format::kSectionIsOptional;
  std::vector<MapSection> sections(header.num_sections);
  std::uint64_t offset = map_format::first_section_offset(header.num_sections);
  for (std::uint32_t i = 0; i < header.num_sections; ++i) {
    SectionRecord& record = sections[i].record;
    std::memcpy(&record, file.data() + sizeof header + i * sizeof record, sizeof record);
    const auto kind = std::find_if(known.begin(), known.end(), [&](const SectionKind& k) { return k.id == record.id; });
    sections[i].kind = kind == known.end() ? nullptr : &*kind;
    sections[i].name = name_of(sections[i].kind, record.id);
    const bool is_in_order = i < map_format::kNumCoreSections ? record.id == SectionId{i} : record.id > sections[i - 1].record.id;
    if (!is_in_order) return corrupt("wrong table entry of section " + sections[i].name);
    if (Status status = check_understood(record, sections[i].kind, sections[i].name, known_flags); !status.is_ok()) return status;
    const auto bytes = section_bytes(file, record, sections[i].name, &offset);
    if (!bytes) return bytes.status();
    sections[i].bytes = *bytes;
  }
  if (offset != file.size()) return corrupt("bytes after the last section");
  return sections;
}

/// Where the bytes of a core section are seen as what they are.
template <typename T>
void set_array(const MapSections& map, SectionId id, std::span<const T>* array) {
  static_assert(map_format::kAlignment % alignof(T) == 0);
  const std::span<const std::byte> bytes = map.section(id);
  // The bytes are aligned and every bit pattern is a valid T: all records are plain numbers.
  *array = {reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T)};
}

}  // namespace

std::uint64_t map_hash(std::span<const std::byte> bytes) { return XXH3_64bits(bytes.data(), bytes.size()); }

std::span<const std::byte> MapSections::section(SectionId id) const {
  const auto found = std::find_if(sections.begin(), sections.end(), [&](const MapSection& section) { return section.record.id == id; });
  return found == sections.end() ? std::span<const std::byte>{} : found->bytes;
}

Result<MapSections> read_map_sections(std::span<const std::byte> bytes, std::span<const SectionKind> known) {
  const Result<FileHeader> header = read_header(bytes);
  if (!header) return header.status();
  Result<std::vector<MapSection>> table = read_table(bytes, *header, known);
  if (!table) return table.status();
  MapSections map;
  map.header = *header;
  map.sections = std::move(*table);
  std::span<const map_format::MetaRecord> meta;
  set_array(map, SectionId::kMeta, &meta);
  if (meta.size() != 1) return corrupt("no meta record");
  map.meta = meta[0];
  set_array(map, SectionId::kCubes, &map.cubes);
  set_array(map, SectionId::kLandmarks, &map.landmarks);
  set_array(map, SectionId::kDescriptors, &map.descriptors);
  set_array(map, SectionId::kKeyframes, &map.keyframes);
  set_array(map, SectionId::kKeyframeLists, &map.keyframe_lists);
  set_array(map, SectionId::kWords, &map.words);
  set_array(map, SectionId::kWordBegin, &map.word_begin);
  set_array(map, SectionId::kInvertedKeyframes, &map.inverted_keyframes);
  set_array(map, SectionId::kInvertedWeights, &map.inverted_weights);
  set_array(map, SectionId::kWcs, &map.wcs);
  return map;
}

Status check_map_content(const MapSections& map) {
  for (const MapSection& section : map.sections) {
    if (section.kind == nullptr || section.kind->check == nullptr) continue;
    if (Status status = section.kind->check(map); !status.is_ok()) return status;
  }
  return Status::ok();
}

}  // namespace camloc
