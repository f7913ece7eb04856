// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Opening: map the file, register the mapping, read the sections, copy the tables of indices, check everything, and only
// then look. The copies are checked, not the file behind them, so that a writer that is busy in the file cannot slip a
// bad index in between.
#include "core/map/map_view.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <utility>
#include <vector>

#include "core/base/unique_fd.h"
#include "core/map/landmark_codes.h"
#include "core/map/mapping_guard.h"

namespace camloc {
namespace {

/// Read-only pages of a file, unmapped at the end.
class Mapping {
 public:
  Mapping() = default;
  Mapping(int fd, std::size_t bytes) : bytes_(bytes) {
    // Populated at once: validation reads every page anyway, and one call is cheaper than a fault for each.
    void* const begin = ::mmap(nullptr, bytes, PROT_READ, MAP_SHARED | MAP_POPULATE, fd, 0);
    if (begin == MAP_FAILED) return;
    begin_ = begin;
    guard_ = MappingGuard(begin, bytes);
  }
  ~Mapping() {
    guard_ = MappingGuard();
    if (begin_ != nullptr) ::munmap(begin_, bytes_);
  }
  Mapping(const Mapping&) = delete;
  Mapping& operator=(const Mapping&) = delete;

  [[nodiscard]] bool is_mapped() const { return begin_ != nullptr; }
  [[nodiscard]] bool is_damaged() const { return guard_.is_damaged(); }
  [[nodiscard]] std::span<const std::byte> bytes() const { return {static_cast<const std::byte*>(begin_), bytes_}; }

 private:
  void* begin_ = nullptr;
  std::size_t bytes_ = 0;
  MappingGuard guard_;
};

Status open_error(ErrorCode code, const std::string& path, const std::string& reason, const char* advice) {
  return {code, "map " + path + ": " + reason + "; " + advice};
}

Status system_error(const std::string& path, int error) {
  const bool is_missing = error == ENOENT || error == ENOTDIR;
  return open_error(is_missing ? ErrorCode::kNotFound : ErrorCode::kIo, path, std::strerror(error),
                    is_missing ? "check the path or make one with 'camloc map build'" : "check its permissions and the disk");
}

Status content_error(const std::string& path, const Status& status) {
  if (status.code() == ErrorCode::kUnsupported) {
    return open_error(status.code(), path, status.message(), "update camloc, or rebuild the map with 'camloc map build' of this version");
  }
  return open_error(ErrorCode::kCorrupt, path, status.message(), "copy it again or rebuild it with 'camloc map build'");
}

Rigid3 to_rigid3(const map_format::TransformRecord& record) {
  const auto& q = record.rotation_wxyz;
  const auto& t = record.translation_m;
  return {map_format::stored_rotation({q[0], q[1], q[2], q[3]}), Eigen::Vector3d(t[0], t[1], t[2])};
}

Intrinsics to_intrinsics(const map_format::IntrinsicsRecord& record) {
  Intrinsics intrinsics;
  intrinsics.width = record.width;
  intrinsics.height = record.height;
  intrinsics.fx = record.fx;
  intrinsics.fy = record.fy;
  intrinsics.cx = record.cx;
  intrinsics.cy = record.cy;
  intrinsics.lens = static_cast<LensModel>(record.lens);
  std::copy(record.distortion.begin(), record.distortion.end(), intrinsics.distortion.begin());
  if (intrinsics.lens == LensModel::kRational) {
    const auto packed = std::bit_cast<std::array<float, 10>>(record.distortion);
    std::copy_n(packed.begin(), intrinsics.distortion.size(), intrinsics.distortion.begin());
  }
  return intrinsics;
}

RgbdCamera to_camera(const map_format::MetaRecord& meta) {
  RgbdCamera camera;
  camera.name = meta.camera_name.data();
  camera.color = to_intrinsics(meta.color);
  camera.depth = to_intrinsics(meta.depth);
  camera.T_color_depth = to_rigid3(meta.T_color_depth);
  camera.is_depth_registered = meta.is_depth_registered != 0;
  camera.depth_unit_m = meta.depth_unit_m;
  camera.min_depth_m = meta.min_depth_m;
  camera.max_depth_m = meta.max_depth_m;
  camera.depth_noise = {meta.depth_noise_constant_m, meta.depth_noise_quadratic_per_m};
  camera.poses_are_of_depth_camera = meta.poses_are_of_depth_camera != 0;
  return camera;
}

WcsDatum to_wcs_datum(const map_format::WcsRecord& record) {
  WcsDatum datum;
  datum.T_wcs_map = to_rigid3(record.T_wcs_map);
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column) datum.covariance(row, column) = record.covariance[row * 6 + column];
  }
  return datum;
}

MapInfo make_info(const std::string& path, const MapSections& map) {
  const auto count = [](const auto& span) { return static_cast<std::uint32_t>(span.size()); };
  MapInfo info;
  info.path = path;
  info.name = map.meta.name.data();
  info.map_id = map.header.map_id;
  info.file_bytes = map.header.file_bytes;
  info.version = map.header.version;
  info.num_cubes = count(map.cubes);
  info.num_landmarks = count(map.landmarks);
  info.num_descriptors = count(map.descriptors);
  info.num_keyframes = count(map.keyframes);
  info.num_words = count(map.words);
  for (const auto& keyframe : map.keyframes) {
    info.max_keyframe_landmarks = std::max(info.max_keyframe_landmarks, keyframe.num_landmark_entries);
  }
  info.orb_scale_factor = map.meta.orb_scale_factor;
  info.orb_num_levels = map.meta.orb_num_levels;
  info.pose_sigma_m = map.meta.pose_sigma_m;
  info.pose_sigma_rad = map.meta.pose_sigma_rad;
  info.camera = to_camera(map.meta);
  if (!map.wcs.empty()) info.wcs = to_wcs_datum(map.wcs[0]);
  return info;
}

/// Replaces a table in the file by a copy.
template <typename T>
void copy_table(std::span<const T>* table, std::vector<T>* copy) {
  copy->assign(table->begin(), table->end());
  *table = *copy;
}

}  // namespace

struct MapView::Impl {
  Impl(int fd, std::size_t bytes) : mapping(fd, bytes) {}

  Status load(const std::string& path);

  Mapping mapping;
  MapInfo info;
  MapSections map;
  std::vector<map_format::CubeRecord> cubes;
  std::vector<map_format::KeyframeRecord> keyframes;
  std::vector<std::uint32_t> word_begin;
  std::vector<std::uint32_t> first_descriptor;  ///< per landmark, and the total at the end
};

/// Everything but the mapping itself.
Status MapView::Impl::load(const std::string& path) {
  Result<MapSections> sections = read_map_sections(mapping.bytes());
  if (!sections) return sections.status();
  map = std::move(*sections);
  copy_table(&map.cubes, &cubes);
  copy_table(&map.keyframes, &keyframes);
  copy_table(&map.word_begin, &word_begin);
  if (Status status = check_map_content(map); !status.is_ok()) return status;

  first_descriptor.reserve(map.landmarks.size() + 1);
  std::uint64_t num_descriptors = 0;
  for (const auto& landmark : map.landmarks) {
    first_descriptor.push_back(static_cast<std::uint32_t>(num_descriptors));
    num_descriptors += landmark.num_descriptors;
    if (num_descriptors > map.descriptors.size()) break;
  }
  first_descriptor.push_back(static_cast<std::uint32_t>(num_descriptors));
  if (num_descriptors != map.descriptors.size()) return {ErrorCode::kCorrupt, "the file was overwritten while it was opened"};

  info = make_info(path, map);
  if (Status status = info.camera.validate(); !status.is_ok()) return {ErrorCode::kCorrupt, "bad camera: " + status.message()};
  if (mapping.is_damaged()) return {ErrorCode::kCorrupt, "the file was truncated while it was opened, or the disk fails"};
  return Status::ok();
}

MapView::MapView(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
MapView::~MapView() = default;
MapView::MapView(MapView&&) noexcept = default;
MapView& MapView::operator=(MapView&&) noexcept = default;

Result<MapView> MapView::open(const std::string& path) {
  // Not blocking: a named pipe must not hold the caller up.
  const UniqueFd fd(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (!fd.is_open()) return system_error(path, errno);
  struct stat status {};
  if (::fstat(fd.get(), &status) != 0) return system_error(path, errno);
  if (S_ISDIR(status.st_mode)) return open_error(ErrorCode::kIo, path, "it is a folder", "name the .cmap file in it");
  if (!S_ISREG(status.st_mode)) return open_error(ErrorCode::kIo, path, "it is no regular file", "name a .cmap file");
  if (status.st_size == 0) return content_error(path, {ErrorCode::kCorrupt, "the file is empty"});

  auto impl = std::make_unique<Impl>(fd.get(), static_cast<std::size_t>(status.st_size));
  if (!impl->mapping.is_mapped()) return system_error(path, errno);
  if (Status loaded = impl->load(path); !loaded.is_ok()) return content_error(path, loaded);
  return MapView(std::move(impl));
}

const MapInfo& MapView::info() const { return impl_->info; }
bool MapView::is_damaged() const { return impl_->mapping.is_damaged(); }
std::span<const MapSection> MapView::sections() const { return impl_->map.sections; }
std::span<const std::byte> MapView::section(map_format::SectionId id) const { return impl_->map.section(id); }
std::span<const map_format::CubeRecord> MapView::cubes() const { return impl_->map.cubes; }
std::span<const map_format::LandmarkRecord> MapView::landmarks() const { return impl_->map.landmarks; }
std::span<const map_format::KeyframeRecord> MapView::keyframes() const { return impl_->map.keyframes; }
std::span<const Descriptor> MapView::descriptors() const { return impl_->map.descriptors; }
std::span<const Descriptor> MapView::words() const { return impl_->map.words; }

std::uint32_t MapView::cube_of(std::uint32_t landmark) const {
  assert(landmark < impl_->info.num_landmarks);
  const auto& cubes = impl_->cubes;
  const auto after = std::upper_bound(cubes.begin(), cubes.end(), landmark,
                                      [](std::uint32_t index, const auto& cube) { return index < cube.first_landmark; });
  return static_cast<std::uint32_t>(after - cubes.begin() - 1);
}

Eigen::Vector3f MapView::position_m(std::uint32_t landmark) const {
  return position_m(impl_->cubes[cube_of(landmark)], impl_->map.landmarks[landmark]);
}

Eigen::Vector3f MapView::direction(const map_format::LandmarkRecord& landmark) { return map_format::decode_direction(landmark.direction); }

float MapView::reference_m(std::uint8_t code) { return map_format::kReferenceTable[code]; }

std::uint32_t MapView::first_descriptor(std::uint32_t landmark) const {
  assert(landmark < impl_->info.num_landmarks);
  return impl_->first_descriptor[landmark];
}

std::uint32_t MapView::num_descriptors(std::uint32_t landmark) const {
  assert(landmark < impl_->info.num_landmarks);
  return impl_->first_descriptor[landmark + 1] - impl_->first_descriptor[landmark];
}

std::span<const Descriptor> MapView::landmark_descriptors(std::uint32_t landmark) const {
  return impl_->map.descriptors.subspan(first_descriptor(landmark), num_descriptors(landmark));
}

Rigid3 MapView::keyframe_pose(std::uint32_t keyframe) const {
  assert(keyframe < impl_->info.num_keyframes);
  const auto& q = impl_->keyframes[keyframe].rotation_wxyz;
  const auto& t = impl_->keyframes[keyframe].position_m;
  return {Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized(), Eigen::Vector3d(t[0], t[1], t[2])};
}

std::size_t MapView::keyframe_landmarks(std::uint32_t keyframe, std::span<std::uint32_t> out) const {
  assert(keyframe < impl_->info.num_keyframes);
  const auto& record = impl_->keyframes[keyframe];
  const std::size_t count = std::min<std::size_t>(record.num_landmark_entries, out.size());
  std::size_t cursor = record.first_list_byte;
  std::uint64_t landmark = 0;
  for (std::size_t i = 0; i < count; ++i) {
    // The list was valid at open; the clamp is for a file that was overwritten since.
    landmark =
        std::min<std::uint64_t>(landmark + map_format::read_varint(impl_->map.keyframe_lists, &cursor), impl_->info.num_landmarks - 1);
    out[i] = static_cast<std::uint32_t>(landmark);
  }
  return count;
}

std::span<const std::uint16_t> MapView::word_keyframes(std::uint32_t word) const {
  assert(word < impl_->info.num_words);
  const std::uint32_t begin = impl_->word_begin[word];
  return impl_->map.inverted_keyframes.subspan(begin, impl_->word_begin[word + 1] - begin);
}

std::span<const std::uint8_t> MapView::word_weights(std::uint32_t word) const {
  assert(word < impl_->info.num_words);
  const std::uint32_t begin = impl_->word_begin[word];
  return impl_->map.inverted_weights.subspan(begin, impl_->word_begin[word + 1] - begin);
}

float MapView::word_idf(std::uint32_t word) const {
  const std::size_t num_keyframes_with_word = word_keyframes(word).size();
  if (num_keyframes_with_word == 0) return 0;
  return std::log1p(static_cast<float>(impl_->info.num_keyframes) / static_cast<float>(num_keyframes_with_word));
}

}  // namespace camloc
