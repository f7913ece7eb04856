// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The sections that this camloc knows, and what makes the content of each safe to use. A further section has its own file
// with its record, its id, its check, and how its bytes are made and read; here it has one line at the end of the table.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

#include "core/map/landmark_codes.h"
#include "core/map/map_ranges.h"
#include "core/map/map_sections.h"

namespace camloc {
namespace {

Status corrupt(std::string reason) { return {ErrorCode::kCorrupt, std::move(reason)}; }

template <typename Array>
bool all_within(const Array& values, double largest) {
  return std::all_of(values.begin(), values.end(), [&](auto value) { return map_ranges::is_within(value, largest); });
}

template <typename Array>
bool is_unit(const Array& values) {
  double squared = 0;
  for (const auto value : values) squared += static_cast<double>(value) * static_cast<double>(value);
  return std::abs(squared - 1) < 1e-3;  // false for NaN
}

bool is_transform(const map_format::TransformRecord& T, double largest_m) {
  return is_unit(T.rotation_wxyz) && all_within(T.translation_m, largest_m);
}

Status check_meta(const MapSections& map) {
  const map_format::MetaRecord& meta = map.meta;
  if (meta.name.back() != '\0' || meta.camera_name.back() != '\0') return corrupt("a name without end");
  if (meta.color.lens > 2 || meta.depth.lens > 2) return corrupt("unknown lens model");
  if (meta.is_depth_registered > 1 || meta.poses_are_of_depth_camera > 1) return corrupt("a flag that is neither 0 nor 1");
  if (!is_transform(meta.T_color_depth, map_ranges::kMaxPosition_m)) return corrupt("T_color_depth is no rigid transform");
  if (!map_ranges::are_pose_sigmas(meta.pose_sigma_m, meta.pose_sigma_rad)) return corrupt("an impossible pose sigma");
  if (!(meta.orb_scale_factor >= 1.01F && meta.orb_scale_factor <= 4) || meta.orb_num_levels < 1 || meta.orb_num_levels > 32) {
    return corrupt("impossible image pyramid");
  }
  return Status::ok();
}

Status check_cubes(const MapSections& map) {
  std::uint64_t next_landmark = 0;
  for (const auto& cube : map.cubes) {
    const bool is_in_range =
        all_within(cube.origin_m, map_ranges::kMaxPosition_m) && map_ranges::is_within(cube.extent_m, map_ranges::kMaxPosition_m);
    if (!is_in_range || !(cube.extent_m > 0)) { return corrupt("a cube without possible place and size"); }
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
    if (!is_unit(keyframe.rotation_wxyz) || !all_within(keyframe.position_m, map_ranges::kMaxPosition_m))
      return corrupt("a keyframe without pose");
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
  const map_format::WcsRecord& datum = map.wcs[0];
  if (!is_transform(datum.T_wcs_map, map_ranges::kMaxWcsPosition_m)) return corrupt("wcs datum at an impossible place");
  const Matrix6d covariance = Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(datum.covariance.data());
  if (!map_ranges::is_covariance(covariance, map_ranges::kMaxWcsPosition_m)) return corrupt("wcs datum with an impossible covariance");
  return Status::ok();
}

/// Also where only one of the two sections is there.
Status check_look_alikes(const MapSections& map) {
  if (map.section(map_format::kTwins).size() != map.landmarks.size()) return corrupt("look-alikes do not belong to these landmarks");
  const std::span<const std::byte> bytes = map.section(map_format::kRivals);
  std::uint32_t last_keyframe = 0;
  for (std::size_t at = 0; at < bytes.size(); at += sizeof(map_format::RivalRecord)) {
    map_format::RivalRecord record;
    std::memcpy(&record, bytes.data() + at, sizeof record);
    const bool is_in_range = record.keyframe < map.keyframes.size() && record.rival < map.keyframes.size();
    if (!is_in_range || record.keyframe == record.rival || record.keyframe < last_keyframe) return corrupt("an impossible look-alike");
    last_keyframe = record.keyframe;
  }
  return Status::ok();
}

using map_format::SectionId;

// Content that only makes sense together is checked with the first of its sections.
constexpr SectionKind kSections[] = {
    {SectionId::kMeta, "meta", sizeof(map_format::MetaRecord), check_meta},
    {SectionId::kCubes, "cubes", sizeof(map_format::CubeRecord), check_cubes},
    {SectionId::kLandmarks, "landmarks", sizeof(map_format::LandmarkRecord), check_landmarks},
    {SectionId::kDescriptors, "descriptors", sizeof(Descriptor), nullptr},
    {SectionId::kKeyframes, "keyframes", sizeof(map_format::KeyframeRecord), check_keyframes},
    {SectionId::kKeyframeLists, "keyframe_lists", 1, nullptr},
    {SectionId::kWords, "words", sizeof(Descriptor), check_inverted_file},
    {SectionId::kWordBegin, "word_begin", sizeof(std::uint32_t), nullptr},
    {SectionId::kInvertedKeyframes, "inverted_keyframes", sizeof(std::uint16_t), nullptr},
    {SectionId::kInvertedWeights, "inverted_weights", 1, nullptr},
    {SectionId::kWcs, "wcs", sizeof(map_format::WcsRecord), check_wcs},
    // ---- further sections
    {map_format::kRivals, "rivals", sizeof(map_format::RivalRecord), check_look_alikes},
    {map_format::kTwins, "twins", 1, check_look_alikes},
};

}  // namespace

std::span<const SectionKind> known_sections() { return kSections; }

}  // namespace camloc
