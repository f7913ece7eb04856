// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A code stands for a range of values. Most codes come back when the value in their middle is encoded again; here are the
// ones that would not: the far face of a cube (which is the near face of the next), cosines (rounded down), and directions
// where two edges of the unfolded octahedron meet.
#include "core/map/map_unpack.h"

#include <charconv>
#include <cmath>
#include <limits>

#include "core/map/landmark_codes.h"

namespace camloc {
namespace {

using map_format::CubeRecord;
using map_format::LandmarkRecord;

/// A float in cube `cell` with this code: next to the middle of what the code stands for.
float unpack_coordinate(std::int32_t cell, std::uint16_t code, double cube_m) {
  const map_format::CubeCoordinate wanted{cell, code};
  const float middle = static_cast<float>(cube_m * (cell + code / 65535.0));
  if (map_format::encode_position(middle, cube_m) == wanted) return middle;
  const float below = std::nextafter(middle, -std::numeric_limits<float>::infinity());
  if (map_format::encode_position(below, cube_m) == wanted) return below;
  const float above = std::nextafter(middle, std::numeric_limits<float>::infinity());
  return map_format::encode_position(above, cube_m) == wanted ? above : middle;
}

Eigen::Vector3f unpack_position(const CubeRecord& cube, const LandmarkRecord& record, double cube_m) {
  Eigen::Vector3f position_m = MapView::position_m(cube, record);
  if (cube.extent_m != static_cast<float>(cube_m)) return position_m;  // not from our writer: cubes of different size
  for (int axis = 0; axis < 3; ++axis) {
    const double cell = std::round(static_cast<double>(cube.origin_m[axis]) / cube_m);
    if (std::abs(cell) > 1e9) continue;
    position_m[axis] = unpack_coordinate(static_cast<std::int32_t>(cell), record.position[axis], cube_m);
  }
  return position_m;
}

/// Where a coordinate vanishes its sign still says on which edge of the square the code lies.
Eigen::Vector3f unpack_direction(const std::array<std::uint8_t, 2>& code) {
  Eigen::Vector3f direction = map_format::decode_direction(code);
  if (map_format::encode_direction(direction) == code) return direction;
  constexpr float kTiny = 1e-6F;
  for (int axis = 0; axis < 2; ++axis) {
    if (std::abs(direction[axis]) < kTiny) direction[axis] = code[axis] < 127 ? -kTiny : kTiny;
  }
  direction.z() -= kTiny;
  return direction.normalized();
}

float unpack_view_cosine(std::uint8_t code) {
  const float cosine = static_cast<float>(code) / 127.5F - 1.0F;
  return map_format::encode_view_cosine(cosine) == code ? cosine : cosine + 1e-6F;
}

MapLandmark unpack_landmark(const MapView& map, const CubeRecord& cube, std::uint32_t index, double cube_m) {
  const LandmarkRecord& record = map.landmarks()[index];
  MapLandmark landmark;
  landmark.position_m = unpack_position(cube, record, cube_m);
  landmark.direction = unpack_direction(record.direction);
  landmark.view_cosine = unpack_view_cosine(record.view_cosine);
  landmark.min_reference_m = MapView::reference_m(record.min_reference);
  landmark.max_reference_m = MapView::reference_m(record.max_reference);
  landmark.angle_rad = MapView::angle_rad(record);
  landmark.position_sigma_m = static_cast<float>(record.position_sigma_mm) / 1000.0F;
  landmark.num_observations = record.num_observations;
  const std::span<const Descriptor> descriptors = map.landmark_descriptors(index);
  landmark.descriptors.assign(descriptors.begin(), descriptors.end());
  return landmark;
}

std::vector<MapLandmark> unpack_landmarks(const MapView& map) {
  const double cube_m = write_options_of(map).cube_m;
  std::vector<MapLandmark> landmarks;
  landmarks.reserve(map.info().num_landmarks);
  for (const CubeRecord& cube : map.cubes()) {
    for (std::uint32_t i = 0; i < cube.num_landmarks; ++i) {
      landmarks.push_back(unpack_landmark(map, cube, cube.first_landmark + i, cube_m));
    }
  }
  return landmarks;
}

MapKeyframe unpack_keyframe(const MapView& map, std::uint32_t index) {
  MapKeyframe keyframe;
  keyframe.T_map_camera = map.keyframe_pose(index);
  const auto& q = map.keyframes()[index].rotation_wxyz;
  const Eigen::Quaterniond as_stored(q[0], q[1], q[2], q[3]);
  // Normalizing changes last bits of the floats.
  if (std::abs(as_stored.norm() - 1) < 5e-7) keyframe.T_map_camera.rotation = as_stored;
  keyframe.landmarks.resize(map.keyframes()[index].num_landmark_entries);
  keyframe.landmarks.resize(map.keyframe_landmarks(index, keyframe.landmarks));
  return keyframe;
}

std::map<map_format::SectionId, ExtraSection> unpack_extra_sections(const MapView& map) {
  std::map<map_format::SectionId, ExtraSection> extra;
  for (const MapSection& section : map.sections().subspan(map_format::kNumCoreSections)) {
    const bool is_optional = (section.record.flags & map_format::kSectionIsOptional) != 0;
    extra[section.record.id] = {is_optional, section.record.element_bytes, {section.bytes.begin(), section.bytes.end()}};
  }
  return extra;
}

std::vector<InvertedEntry> unpack_entries(const MapView& map, std::uint32_t word) {
  const auto keyframes = map.word_keyframes(word);
  const auto weights = map.word_weights(word);
  std::vector<InvertedEntry> entries(keyframes.size());
  for (std::size_t i = 0; i < entries.size(); ++i) entries[i] = {keyframes[i], weights[i]};
  return entries;
}

}  // namespace

MapData unpack_map(const MapView& map) {
  const MapInfo& info = map.info();
  MapData data;
  data.name = info.name;
  data.camera = info.camera;
  data.orb_scale_factor = info.orb_scale_factor;
  data.orb_num_levels = info.orb_num_levels;
  data.pose_sigma_m = info.pose_sigma_m;
  data.pose_sigma_rad = info.pose_sigma_rad;
  data.landmarks = unpack_landmarks(map);
  for (std::uint32_t k = 0; k < info.num_keyframes; ++k) data.keyframes.push_back(unpack_keyframe(map, k));
  data.words.assign(map.words().begin(), map.words().end());
  for (std::uint32_t w = 0; w < info.num_words; ++w) data.inverted_file.push_back(unpack_entries(map, w));
  data.wcs = info.wcs;
  data.extra_sections = unpack_extra_sections(map);
  return data;
}

MapWriteOptions write_options_of(const MapView& map) {
  // The file has the nearest float; the shortest decimal with that float is the number somebody wrote.
  char text[32];
  const float extent_m = map.cubes().front().extent_m;
  const auto end = std::to_chars(text, text + sizeof text, extent_m).ptr;
  MapWriteOptions options;
  options.cube_m = static_cast<double>(extent_m);
  std::from_chars(text, end, options.cube_m);
  return options;
}

}  // namespace camloc
