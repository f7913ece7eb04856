// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Structure first (header, table, bounds, hashes), then meaning. The reasons given here get the path and the advice in
// front and behind by MapView::open.
#include "core/map/map_sections.h"

#include <xxhash.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include "core/base/checked.h"
#include "core/map/landmark_codes.h"

namespace camloc {
namespace {

using map_format::FileHeader;
using map_format::SectionId;
using map_format::SectionRecord;

constexpr std::uint64_t kTableOffset = sizeof(FileHeader);
constexpr std::uint64_t kTableEnd = kTableOffset + map_format::kNumSections * sizeof(SectionRecord);
constexpr std::uint64_t kFirstSection = (kTableEnd + map_format::kAlignment - 1) & ~(map_format::kAlignment - 1);
/// Tables are indexed with 32 bits.
constexpr std::uint64_t kMaxElements = std::numeric_limits<std::uint32_t>::max() - 1;

Status corrupt(std::string reason) { return {ErrorCode::kCorrupt, std::move(reason)}; }

Result<FileHeader> read_header(std::span<const std::byte> bytes) {
  FileHeader header;
  if (bytes.size() < sizeof header.magic) return corrupt("the file is too short to be a map");
  std::memcpy(&header.magic, bytes.data(), sizeof header.magic);
  if (header.magic != map_format::kMagic) return corrupt("the file does not begin like a camloc map");
  if (bytes.size() < sizeof header) return corrupt("the file is truncated in its header");
  std::memcpy(&header, bytes.data(), sizeof header);
  if (header.byte_order == map_format::kOtherByteOrder) {
    return Status(ErrorCode::kUnsupported, "made on a machine of the other byte order");
  }
  const std::uint64_t hash = map_hash(bytes.first(offsetof(FileHeader, header_hash)));
  if (header.header_hash != hash || header.byte_order != map_format::kByteOrder) return corrupt("the header is damaged");
  if (header.version > map_format::kVersion) {
    return Status(ErrorCode::kUnsupported, "made by a newer camloc (format " + std::to_string(header.version) + ", this one reads " +
                                               std::to_string(map_format::kVersion) + ")");
  }
  if (header.version < map_format::kVersion) {
    return Status(ErrorCode::kUnsupported, "format " + std::to_string(header.version) + " is no longer read");
  }
  if (header.file_bytes > bytes.size()) {
    return corrupt("the file is truncated: " + std::to_string(bytes.size()) + " of " + std::to_string(header.file_bytes) + " bytes");
  }
  if (header.file_bytes < bytes.size()) return corrupt("the file is longer than its header says");
  if (header.num_sections != map_format::kNumSections || bytes.size() < kFirstSection) return corrupt("wrong section table");
  if (header.map_id != map_hash(bytes.subspan(kTableOffset, kFirstSection - kTableOffset))) {
    return corrupt("the section table is damaged");
  }
  return header;
}

/// Walks through the table: every section is where the one before ended, has whole elements and the right hash.
class SectionReader {
 public:
  explicit SectionReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  /// The next section as an array of T, empty after the first error.
  template <typename T>
  std::span<const T> next() {
    static_assert(map_format::kAlignment % alignof(T) == 0);
    if (!status_.is_ok()) return {};
    SectionRecord record;
    std::memcpy(&record, bytes_.data() + kTableOffset + index_ * sizeof record, sizeof record);
    status_ = check(record, sizeof(T));
    ++index_;
    if (!status_.is_ok()) return {};
    // The bytes are aligned and every bit pattern is a valid T: all records are plain numbers.
    return {reinterpret_cast<const T*>(bytes_.data() + record.offset), static_cast<std::size_t>(record.num_elements)};
  }

  Status finish() {
    if (status_.is_ok() && offset_ != bytes_.size()) status_ = corrupt("bytes after the last section");
    return status_;
  }

 private:
  Status check(const SectionRecord& record, std::size_t element_bytes) {
    const std::string name = map_format::kSectionNames[index_];
    if (static_cast<std::uint32_t>(record.id) != index_ || record.element_bytes != element_bytes || record.offset != offset_ ||
        record.num_elements > kMaxElements) {
      return corrupt("wrong table entry of section " + name);
    }
    const auto end = checked_end(record.offset, record.num_elements, element_bytes);
    const auto padded_end = end ? checked_align_up(*end, map_format::kAlignment) : std::nullopt;
    if (!padded_end || *padded_end > bytes_.size()) return corrupt("section " + name + " does not fit into the file");
    if (map_hash(bytes_.subspan(record.offset, *padded_end - record.offset)) != record.hash) {
      return corrupt("checksum of section " + name + " does not match");
    }
    offset_ = *padded_end;
    return Status::ok();
  }

  std::span<const std::byte> bytes_;
  std::uint32_t index_ = 0;
  std::uint64_t offset_ = kFirstSection;
  Status status_;
};

template <typename Array>
bool all_finite(const Array& values) {
  for (const auto value : values) {
    if (!std::isfinite(value)) return false;
  }
  return true;
}

template <typename Array>
bool is_unit(const Array& values) {
  double squared = 0;
  for (const auto value : values) squared += static_cast<double>(value) * static_cast<double>(value);
  return std::abs(squared - 1) < 1e-3;  // false for NaN
}

bool is_transform(const map_format::TransformRecord& T) { return is_unit(T.rotation_wxyz) && all_finite(T.translation_m); }

Status check_meta(const map_format::MetaRecord& meta) {
  if (meta.name.back() != '\0' || meta.camera_name.back() != '\0') return corrupt("a name without end");
  if (meta.color.lens > 2 || meta.depth.lens > 2) return corrupt("unknown lens model");
  if (meta.is_depth_registered > 1 || meta.poses_are_of_depth_camera > 1) return corrupt("a flag that is neither 0 nor 1");
  if (!is_transform(meta.T_color_depth)) return corrupt("T_color_depth is no rigid transform");
  if (!(meta.pose_sigma_m >= 0 && std::isfinite(meta.pose_sigma_m)) || !(meta.pose_sigma_rad >= 0 && std::isfinite(meta.pose_sigma_rad))) {
    return corrupt("negative or infinite pose sigma");
  }
  if (!(meta.orb_scale_factor >= 1.01F && meta.orb_scale_factor <= 4) || meta.orb_num_levels < 1 || meta.orb_num_levels > 32) {
    return corrupt("impossible image pyramid");
  }
  return Status::ok();
}

Status check_cubes(const MapSections& map) {
  std::uint64_t next_landmark = 0;
  for (const auto& cube : map.cubes) {
    if (!all_finite(cube.origin_m) || !(cube.extent_m > 0 && std::isfinite(cube.extent_m))) {
      return corrupt("a cube without finite place and size");
    }
    if (cube.first_landmark != next_landmark || cube.num_landmarks == 0) return corrupt("cubes with gaps or overlap");
    next_landmark += cube.num_landmarks;
  }
  if (next_landmark != map.landmarks.size()) return corrupt("cubes do not hold all landmarks");
  return Status::ok();
}

Status check_landmarks(const MapSections& map) {
  if (map.landmarks.empty()) return corrupt("no landmark");
  std::uint64_t num_descriptors = 0;
  for (const auto& landmark : map.landmarks) {
    if (landmark.num_descriptors == 0) return corrupt("a landmark without descriptor");
    num_descriptors += landmark.num_descriptors;
  }
  if (num_descriptors != map.descriptors.size()) return corrupt("descriptor counts do not add up");
  return Status::ok();
}

/// The list of one keyframe; `*cursor` moves from its begin to its end.
Status check_list(const MapSections& map, const map_format::KeyframeRecord& keyframe, std::size_t* cursor) {
  if (keyframe.first_list_byte != *cursor) return corrupt("keyframe lists with gaps or overlap");
  std::uint64_t landmark = 0;
  for (std::uint32_t i = 0; i < keyframe.num_landmark_entries; ++i) {
    if (*cursor >= map.keyframe_lists.size()) return corrupt("a keyframe list without end");
    const std::uint32_t step = map_format::read_varint(map.keyframe_lists, cursor);
    if (i > 0 && step == 0) return corrupt("a keyframe list that is not ascending");
    landmark += step;
    if (landmark >= map.landmarks.size()) return corrupt("a keyframe list with a landmark that does not exist");
  }
  return Status::ok();
}

Status check_keyframes(const MapSections& map) {
  if (map.keyframes.size() > map_format::kMaxKeyframes) return corrupt("too many keyframes");
  std::size_t cursor = 0;
  for (const auto& keyframe : map.keyframes) {
    if (!is_unit(keyframe.rotation_wxyz) || !all_finite(keyframe.position_m)) return corrupt("a keyframe without pose");
    if (Status status = check_list(map, keyframe, &cursor); !status.is_ok()) return status;
  }
  if (cursor != map.keyframe_lists.size()) return corrupt("keyframe lists with bytes left over");
  return Status::ok();
}

Status check_inverted_file(const MapSections& map) {
  const std::size_t num_entries = map.inverted_keyframes.size();
  if (map.inverted_weights.size() != num_entries || map.word_begin.size() != map.words.size() + 1 || map.word_begin.front() != 0 ||
      map.word_begin.back() != num_entries) {
    return corrupt("inverted file and words do not belong together");
  }
  for (std::size_t word = 0; word < map.words.size(); ++word) {
    const std::uint32_t begin = map.word_begin[word], end = map.word_begin[word + 1];
    if (begin > end || end > num_entries) return corrupt("inverted file with gaps or overlap");
    for (std::uint32_t i = begin; i < end; ++i) {
      const bool is_ascending = i == begin || map.inverted_keyframes[i] > map.inverted_keyframes[i - 1];
      if (map.inverted_keyframes[i] >= map.keyframes.size() || !is_ascending || map.inverted_weights[i] == 0) {
        return corrupt("inverted file with an impossible entry");
      }
    }
  }
  return Status::ok();
}

Status check_wcs(const MapSections& map) {
  if (map.wcs.empty()) return Status::ok();
  if (map.wcs.size() > 1) return corrupt("more than one world coordinate system");
  if (!is_transform(map.wcs[0].T_wcs_map) || !all_finite(map.wcs[0].covariance)) return corrupt("wcs datum not finite");
  return Status::ok();
}

}  // namespace

std::uint64_t map_hash(std::span<const std::byte> bytes) { return XXH3_64bits(bytes.data(), bytes.size()); }

Result<MapSections> read_map_sections(std::span<const std::byte> bytes) {
  const Result<FileHeader> header = read_header(bytes);
  if (!header) return header.status();
  MapSections map;
  map.header = *header;
  SectionReader reader(bytes);
  const auto meta = reader.next<map_format::MetaRecord>();
  map.cubes = reader.next<map_format::CubeRecord>();
  map.landmarks = reader.next<map_format::LandmarkRecord>();
  map.descriptors = reader.next<Descriptor>();
  map.keyframes = reader.next<map_format::KeyframeRecord>();
  map.keyframe_lists = reader.next<std::uint8_t>();
  map.words = reader.next<Descriptor>();
  map.word_begin = reader.next<std::uint32_t>();
  map.inverted_keyframes = reader.next<std::uint16_t>();
  map.inverted_weights = reader.next<std::uint8_t>();
  map.wcs = reader.next<map_format::WcsRecord>();
  if (Status status = reader.finish(); !status.is_ok()) return status;
  if (meta.size() != 1) return corrupt("no meta record");
  map.meta = meta[0];
  return map;
}

Status check_map_content(const MapSections& map) {
  using Check = Status (*)(const MapSections&);
  constexpr Check kChecks[] = {check_cubes, check_landmarks, check_keyframes, check_inverted_file, check_wcs};
  if (Status status = check_meta(map.meta); !status.is_ok()) return status;
  for (const Check check : kChecks) {
    if (Status status = check(map); !status.is_ok()) return status;
  }
  return Status::ok();
}

}  // namespace camloc
