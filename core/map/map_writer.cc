// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Checks the data, orders the landmarks, encodes the core sections one after the other, copies the further ones, and seals
// everything with hashes. A file on disk is replaced at the end, in one step.
#include "core/map/map_writer.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>
#include <tuple>
#include <utility>

#include "core/io/file_bytes.h"
#include "core/map/landmark_codes.h"
#include "core/map/map_format.h"
#include "core/map/map_ranges.h"
#include "core/map/map_sections.h"

namespace camloc {
namespace {

using map_format::LandmarkRecord;
using map_format::SectionId;

constexpr double kMaxCoordinateM = 1e6;  ///< farther out a float has less than a decimetre
constexpr std::size_t kMaxDescriptors = 255;

Status invalid(const std::string& reason) { return {ErrorCode::kInvalid, "cannot pack the map: " + reason}; }

bool is_unit(const Eigen::Quaterniond& rotation) { return std::abs(rotation.norm() - 1) < 1e-6; }
bool is_transform(const Rigid3& T, double largest_m = map_ranges::kMaxPosition_m) {
  return is_unit(T.rotation) && T.translation.cwiseAbs().maxCoeff() <= largest_m && T.translation.allFinite();
}

// ---- checks

Status check_landmark(const MapLandmark& landmark) {
  if (!landmark.position_m.allFinite() || landmark.position_m.lpNorm<Eigen::Infinity>() > kMaxCoordinateM) {
    return invalid("a landmark more than 1000 km from the origin, or nowhere");
  }
  if (!landmark.direction.allFinite() || landmark.direction.norm() < 0.5F) return invalid("a landmark without direction");
  if (!std::isfinite(landmark.view_cosine) || !std::isfinite(landmark.angle_rad) || !(landmark.position_sigma_m >= 0) ||
      !(landmark.min_reference_m >= 0) || !(landmark.max_reference_m >= landmark.min_reference_m)) {
    return invalid("a landmark with impossible view, distance or scatter");
  }
  if (landmark.descriptors.empty() || landmark.descriptors.size() > kMaxDescriptors) {
    return invalid("a landmark with " + std::to_string(landmark.descriptors.size()) + " descriptors instead of 1 to 255");
  }
  return Status::ok();
}

Status check_keyframe(const MapKeyframe& keyframe, std::size_t num_landmarks) {
  if (!is_transform(keyframe.T_map_camera)) return invalid("a keyframe without pose");
  for (std::size_t i = 0; i < keyframe.landmarks.size(); ++i) {
    if (keyframe.landmarks[i] >= num_landmarks) return invalid("a keyframe sees a landmark that does not exist");
    if (i > 0 && keyframe.landmarks[i] <= keyframe.landmarks[i - 1]) return invalid("a keyframe list that is not ascending");
  }
  return Status::ok();
}

Status check_words(const MapData& map) {
  if (map.inverted_file.size() != map.words.size()) return invalid("inverted file and words differ in length");
  for (const auto& entries : map.inverted_file) {
    for (std::size_t i = 0; i < entries.size(); ++i) {
      if (entries[i].keyframe >= map.keyframes.size() || entries[i].weight == 0) return invalid("an impossible inverted entry");
      if (i > 0 && entries[i].keyframe <= entries[i - 1].keyframe) return invalid("an inverted list that is not ascending");
    }
  }
  return Status::ok();
}

Status check_globals(const MapData& map) {
  if (map.name.size() >= sizeof(map_format::MetaRecord::name)) return invalid("a name of more than 63 bytes");
  if (Status status = map.camera.validate(); !status.is_ok()) return invalid(status.message());
  if (!is_transform(map.camera.T_color_depth)) return invalid("T_color_depth is no rigid transform");
  if (!map_ranges::are_pose_sigmas(map.pose_sigma_m, map.pose_sigma_rad)) return invalid("an impossible pose sigma");
  if (!(map.orb_scale_factor >= 1 && map.orb_scale_factor <= 4) || map.orb_num_levels < 1 || map.orb_num_levels > 32) {
    return invalid("impossible image pyramid");
  }
  if (map.wcs && (!is_transform(map.wcs->T_wcs_map, map_ranges::kMaxWcsPosition_m) ||
                  !map_ranges::is_covariance(map.wcs->covariance, map_ranges::kMaxWcsPosition_m))) {
    return invalid("an impossible world coordinate system");
  }
  return Status::ok();
}

Status check_extra_sections(const MapData& map) {
  if (map.extra_sections.size() > map_format::kMaxSections - map_format::kNumCoreSections) return invalid("too many sections");
  for (const auto& [id, section] : map.extra_sections) {
    if (static_cast<std::uint32_t>(id) < map_format::kNumCoreSections) return invalid("an extra section with the id of a core one");
    if (section.element_bytes == 0 || section.bytes.size() % section.element_bytes != 0)
      return invalid("an extra section of broken elements");
  }
  return Status::ok();
}

Status check_map(const MapData& map, const MapWriteOptions& options) {
  if (map.landmarks.empty()) return invalid("it has no landmark");
  if (map.landmarks.size() >= std::numeric_limits<std::int32_t>::max()) return invalid("it has too many landmarks");
  if (map.keyframes.size() > map_format::kMaxKeyframes) return invalid("it has more than 65535 keyframes");
  if (!(options.cube_m >= 0.01 && options.cube_m <= 1e4)) return invalid("cubes must be 0.01 to 10000 m wide");
  if (Status status = check_globals(map); !status.is_ok()) return status;
  if (Status status = check_extra_sections(map); !status.is_ok()) return status;
  for (const auto& landmark : map.landmarks) {
    if (Status status = check_landmark(landmark); !status.is_ok()) return status;
  }
  for (const auto& keyframe : map.keyframes) {
    if (Status status = check_keyframe(keyframe, map.landmarks.size()); !status.is_ok()) return status;
  }
  return check_words(map);
}

// ---- order of the landmarks

using Cell = std::array<std::int32_t, 3>;

/// Where a landmark goes: its cube, its place in it.
struct Placement {
  Cell cell{};
  std::array<std::uint16_t, 3> position{};
  std::uint64_t morton = 0;
  std::uint32_t original = 0;
};

/// The 16 bits of `value` three apart.
std::uint64_t spread_bits(std::uint64_t value) {
  std::uint64_t spread = 0;
  for (unsigned bit = 0; bit < 16; ++bit) spread |= ((value >> bit) & 1U) << (3 * bit);
  return spread;
}

Placement place(const Eigen::Vector3f& position_m, double cube_m, std::uint32_t original) {
  Placement placement;
  placement.original = original;
  for (int axis = 0; axis < 3; ++axis) {
    const map_format::CubeCoordinate coordinate = map_format::encode_position(position_m[axis], cube_m);
    placement.cell[axis] = coordinate.cell;
    placement.position[axis] = coordinate.code;
    placement.morton |= spread_bits(placement.position[axis]) << axis;
  }
  return placement;
}

/// All landmarks by cube, then along the Morton curve: neighbours in space become neighbours in the file, which makes the
/// keyframe lists short and a walk through a cube sequential.
std::vector<Placement> order_landmarks(const MapData& map, double cube_m) {
  std::vector<Placement> order;
  order.reserve(map.landmarks.size());
  for (std::uint32_t i = 0; i < map.landmarks.size(); ++i) order.push_back(place(map.landmarks[i].position_m, cube_m, i));
  std::sort(order.begin(), order.end(), [](const Placement& a, const Placement& b) {
    return std::tie(a.cell, a.morton, a.original) < std::tie(b.cell, b.morton, b.original);
  });
  return order;
}

// ---- records

template <std::size_t N>
void set_text(const std::string& text, std::array<char, N>* field) {
  // Up to the first zero: what a reader would see.
  std::memcpy(field->data(), text.data(), std::min(std::strlen(text.c_str()), N - 1));
}

map_format::TransformRecord to_record(const Rigid3& T) {
  const Eigen::Quaterniond q = map_format::stored_rotation(T.rotation);
  const auto& t = T.translation;
  return {{q.w(), q.x(), q.y(), q.z()}, {t.x(), t.y(), t.z()}};
}

map_format::IntrinsicsRecord to_record(const Intrinsics& camera) {
  map_format::IntrinsicsRecord record{};
  record.width = camera.width;
  record.height = camera.height;
  record.lens = static_cast<std::uint32_t>(camera.lens);
  record.fx = camera.fx;
  record.fy = camera.fy;
  record.cx = camera.cx;
  record.cy = camera.cy;
  std::copy_n(camera.distortion.begin(), record.distortion.size(), record.distortion.begin());
  if (camera.lens == LensModel::kRational) {
    std::array<float, 10> packed{};
    std::transform(camera.distortion.begin(), camera.distortion.end(), packed.begin(), [](double k) { return static_cast<float>(k); });
    record.distortion = std::bit_cast<std::array<double, 5>>(packed);
  }
  return record;
}

map_format::MetaRecord make_meta(const MapData& map) {
  map_format::MetaRecord meta{};
  set_text(map.name, &meta.name);
  set_text(map.camera.name, &meta.camera_name);
  meta.color = to_record(map.camera.color);
  meta.depth = to_record(map.camera.depth);
  meta.T_color_depth = to_record(map.camera.T_color_depth);
  meta.depth_unit_m = map.camera.depth_unit_m;
  meta.min_depth_m = map.camera.min_depth_m;
  meta.max_depth_m = map.camera.max_depth_m;
  meta.depth_noise_constant_m = map.camera.depth_noise.constant_m;
  meta.depth_noise_quadratic_per_m = map.camera.depth_noise.quadratic_per_m;
  meta.is_depth_registered = map.camera.is_depth_registered ? 1 : 0;
  meta.poses_are_of_depth_camera = map.camera.poses_are_of_depth_camera ? 1 : 0;
  meta.pose_sigma_m = map.pose_sigma_m;
  meta.pose_sigma_rad = map.pose_sigma_rad;
  meta.orb_scale_factor = map.orb_scale_factor;
  meta.orb_num_levels = map.orb_num_levels;
  return meta;
}

LandmarkRecord to_record(const MapLandmark& landmark, const Placement& placement) {
  LandmarkRecord record{};
  record.position = placement.position;
  record.direction = map_format::encode_direction(landmark.direction);
  record.view_cosine = map_format::encode_view_cosine(landmark.view_cosine);
  record.min_reference = map_format::encode_reference_down(landmark.min_reference_m);
  record.max_reference = map_format::encode_reference_up(landmark.max_reference_m);
  record.angle = map_format::encode_angle(landmark.angle_rad);
  record.num_observations = static_cast<std::uint8_t>(std::min<std::uint32_t>(landmark.num_observations, 255));
  record.num_descriptors = static_cast<std::uint8_t>(landmark.descriptors.size());
  record.position_sigma_mm = static_cast<std::uint16_t>(std::lround(std::min(landmark.position_sigma_m * 1000.0F, 65535.0F)));
  return record;
}

std::vector<map_format::CubeRecord> make_cubes(const std::vector<Placement>& order, double cube_m) {
  std::vector<map_format::CubeRecord> cubes;
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    if (i == 0 || order[i].cell != order[i - 1].cell) {
      const auto corner = [&](int axis) { return static_cast<float>(order[i].cell[axis] * cube_m); };
      cubes.push_back({{corner(0), corner(1), corner(2)}, static_cast<float>(cube_m), i, 0});
    }
    ++cubes.back().num_landmarks;
  }
  return cubes;
}

// ---- the file

/// Grows the file section by section.
class FileBuilder {
 public:
  explicit FileBuilder(std::size_t num_sections) : bytes_(map_format::first_section_offset(static_cast<std::uint32_t>(num_sections))) {}

  template <typename T>
  void add(SectionId id, const std::vector<T>& elements) {
    add_bytes({id, sizeof(T), 0, bytes_.size(), elements.size(), 0}, std::as_bytes(std::span(elements)));
  }

  void add(SectionId id, const ExtraSection& section) {
    const std::uint16_t flags = section.is_optional ? map_format::kSectionIsOptional : 0;
    add_bytes({id, section.element_bytes, flags, bytes_.size(), section.bytes.size() / section.element_bytes, 0}, section.bytes);
  }

  std::vector<std::byte> finish() && {
    map_format::FileHeader header{};
    header.magic = map_format::kMagic;
    header.byte_order = map_format::kByteOrder;
    header.version = map_format::kVersion;
    header.file_bytes = bytes_.size();
    header.num_sections = num_sections_;
    const std::span<const std::byte> bytes = bytes_;
    header.map_id = map_hash(bytes.subspan(sizeof header, map_format::first_section_offset(num_sections_) - sizeof header));
    std::memcpy(bytes_.data(), &header, sizeof header);
    header.header_hash = map_hash(bytes.first(offsetof(map_format::FileHeader, header_hash)));
    std::memcpy(bytes_.data(), &header, sizeof header);
    return std::move(bytes_);
  }

 private:
  void add_bytes(map_format::SectionRecord record, std::span<const std::byte> content) {
    bytes_.resize((record.offset + content.size() + map_format::kAlignment - 1) & ~(map_format::kAlignment - 1));
    if (!content.empty()) std::memcpy(bytes_.data() + record.offset, content.data(), content.size());
    record.hash = map_hash(std::span<const std::byte>(bytes_).subspan(record.offset));
    std::memcpy(bytes_.data() + sizeof(map_format::FileHeader) + num_sections_ * sizeof record, &record, sizeof record);
    ++num_sections_;
  }

  std::vector<std::byte> bytes_;
  std::uint32_t num_sections_ = 0;
};

void add_landmarks(const MapData& map, const std::vector<Placement>& order, FileBuilder* file) {
  std::vector<LandmarkRecord> records;
  std::vector<Descriptor> descriptors;
  records.reserve(order.size());
  for (const Placement& placement : order) {
    const MapLandmark& landmark = map.landmarks[placement.original];
    records.push_back(to_record(landmark, placement));
    descriptors.insert(descriptors.end(), landmark.descriptors.begin(), landmark.descriptors.end());
  }
  file->add(SectionId::kLandmarks, records);
  file->add(SectionId::kDescriptors, descriptors);
}

void add_keyframes(const MapData& map, const std::vector<Placement>& order, FileBuilder* file) {
  std::vector<std::uint32_t> new_index(order.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) new_index[order[i].original] = i;

  std::vector<map_format::KeyframeRecord> records;
  std::vector<std::uint8_t> lists;
  std::vector<std::uint32_t> list;
  for (const MapKeyframe& keyframe : map.keyframes) {
    const Eigen::Quaternionf q = keyframe.T_map_camera.rotation.cast<float>();
    const Eigen::Vector3f t = keyframe.T_map_camera.translation.cast<float>();
    records.push_back({{q.w(), q.x(), q.y(), q.z()},
                       {t.x(), t.y(), t.z()},
                       static_cast<std::uint32_t>(lists.size()),
                       static_cast<std::uint32_t>(keyframe.landmarks.size())});
    list.clear();
    for (const std::uint32_t landmark : keyframe.landmarks) list.push_back(new_index[landmark]);
    std::sort(list.begin(), list.end());
    std::uint32_t previous = 0;
    for (const std::uint32_t landmark : list) map_format::append_varint(landmark - std::exchange(previous, landmark), &lists);
  }
  file->add(SectionId::kKeyframes, records);
  file->add(SectionId::kKeyframeLists, lists);
}

void add_words(const MapData& map, FileBuilder* file) {
  std::vector<std::uint32_t> begin = {0};
  std::vector<std::uint16_t> keyframes;
  std::vector<std::uint8_t> weights;
  for (const auto& entries : map.inverted_file) {
    for (const InvertedEntry& entry : entries) {
      keyframes.push_back(entry.keyframe);
      weights.push_back(entry.weight);
    }
    begin.push_back(static_cast<std::uint32_t>(keyframes.size()));
  }
  file->add(SectionId::kWords, map.words);
  file->add(SectionId::kWordBegin, begin);
  file->add(SectionId::kInvertedKeyframes, keyframes);
  file->add(SectionId::kInvertedWeights, weights);
}

void add_wcs(const MapData& map, FileBuilder* file) {
  std::vector<map_format::WcsRecord> records;
  if (map.wcs) {
    map_format::WcsRecord& record = records.emplace_back();
    record.T_wcs_map = to_record(map.wcs->T_wcs_map);
    for (int row = 0; row < 6; ++row) {
      for (int column = 0; column < 6; ++column) record.covariance[row * 6 + column] = map.wcs->covariance(row, column);
    }
  }
  file->add(SectionId::kWcs, records);
}

}  // namespace

Result<std::vector<std::byte>> serialize_map(const MapData& map, const MapWriteOptions& options) {
  if (Status status = check_map(map, options); !status.is_ok()) return status;
  const std::vector<Placement> order = order_landmarks(map, options.cube_m);
  FileBuilder file(map_format::kNumCoreSections + map.extra_sections.size());
  file.add(SectionId::kMeta, std::vector{make_meta(map)});
  file.add(SectionId::kCubes, make_cubes(order, options.cube_m));
  add_landmarks(map, order, &file);
  add_keyframes(map, order, &file);
  add_words(map, &file);
  add_wcs(map, &file);
  for (const auto& [id, section] : map.extra_sections) file.add(id, section);
  return std::move(file).finish();
}

Status write_map(const MapData& map, const std::string& path, const MapWriteOptions& options) {
  const Result<std::vector<std::byte>> bytes = serialize_map(map, options);
  if (!bytes) return bytes.status();
  return replace_file(path, *bytes);
}

}  // namespace camloc
