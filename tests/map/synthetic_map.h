// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Maps made of numbers from a seed, and what tests do to their bytes. The same options give the same map on every
// machine: only the raw output of mt19937 and plain arithmetic are used.
#pragma once

#include <stdlib.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "core/map/map_data.h"
#include "core/map/map_format.h"
#include "core/map/map_sections.h"

namespace camloc::testing {

struct SyntheticMapOptions {
  std::uint32_t num_landmarks = 40;
  std::uint32_t num_keyframes = 3;
  std::uint32_t landmarks_per_keyframe = 15;
  std::uint32_t num_words = 8;
  std::uint32_t extra_descriptors_percent = 30;  ///< of the landmarks with a second descriptor
  double side_m = 10;
  bool has_wcs = true;
  std::uint32_t seed = 1;
};

class Random {
 public:
  explicit Random(std::uint32_t seed) : engine_(seed) {}
  std::uint32_t next() { return static_cast<std::uint32_t>(engine_()); }
  std::uint32_t below(std::uint32_t bound) { return next() % bound; }
  double uniform(double low, double high) { return low + (high - low) * (next() * (1.0 / 4294967296.0)); }
  Eigen::Quaterniond rotation() {
    const double x = uniform(-1, 1), y = uniform(-1, 1), z = uniform(-1, 1);
    return Eigen::Quaterniond(1, x, y, z).normalized();
  }
  Eigen::Vector3d direction() {
    for (;;) {
      const double x = uniform(-1, 1), y = uniform(-1, 1), z = uniform(-1, 1);
      const Eigen::Vector3d v(x, y, z);
      if (v.norm() > 0.1 && v.norm() < 1) return v.normalized();
    }
  }
  Descriptor descriptor() {
    Descriptor d;
    for (auto& word : d.bits) {
      word = next();
      word = word << 32 | next();
    }
    return d;
  }
  /// The descriptor with `num_bits` random bits flipped (fewer when one is hit twice).
  Descriptor noisy(const Descriptor& descriptor, int num_bits) {
    Descriptor d = descriptor;
    for (int i = 0; i < num_bits; ++i) {
      const std::uint32_t bit = below(256);
      d.bits[bit / 64] ^= std::uint64_t{1} << (bit % 64);
    }
    return d;
  }

 private:
  std::mt19937 engine_;
};

inline RgbdCamera synthetic_camera() {
  RgbdCamera camera;
  camera.name = "synthetic";
  camera.color = {640, 480, 525, 526, 320.5, 240.25, LensModel::kBrownConrady, {0.1, -0.2, 0.001, -0.002, 0.05}};
  camera.depth = {640, 480, 585, 584, 319, 241, LensModel::kPinhole, {}};
  camera.T_color_depth = {Eigen::Quaterniond(1, 0.01, -0.02, 0.005).normalized(), {0.025, 0.001, -0.002}};
  camera.is_depth_registered = false;
  camera.depth_noise = {0.002, 0.005};
  camera.poses_are_of_depth_camera = true;
  return camera;
}

inline MapLandmark synthetic_landmark(const SyntheticMapOptions& options, const std::vector<Descriptor>& words, Random* random) {
  MapLandmark landmark;
  for (int axis = 0; axis < 3; ++axis) {
    landmark.position_m[axis] = static_cast<float>(random->uniform(-0.5 * options.side_m, 0.5 * options.side_m));
  }
  landmark.direction = random->direction().cast<float>();
  landmark.view_cosine = static_cast<float>(random->uniform(0.3, 1));
  landmark.min_reference_m = static_cast<float>(random->uniform(0.5, 5));
  landmark.max_reference_m = landmark.min_reference_m * static_cast<float>(random->uniform(1, 3));
  landmark.angle_rad = static_cast<float>(random->uniform(0, 6.28));
  landmark.position_sigma_m = static_cast<float>(random->uniform(0.001, 0.05));
  landmark.num_observations = 1 + random->below(400);
  const bool has_two = random->below(100) < options.extra_descriptors_percent;
  for (int i = 0; i < (has_two ? 2 : 1); ++i) {
    const std::uint32_t word = words.empty() ? 0 : random->below(static_cast<std::uint32_t>(words.size()));
    landmark.descriptors.push_back(words.empty() ? random->descriptor() : random->noisy(words[word], 20));
  }
  return landmark;
}

/// Index of the closest word, the first of several.
inline std::uint32_t nearest_word(const std::vector<Descriptor>& words, const Descriptor& descriptor) {
  std::uint32_t best = 0;
  int best_distance = 257;
  for (std::uint32_t w = 0; w < words.size(); ++w) {
    int distance = 0;
    for (int i = 0; i < 4; ++i) distance += __builtin_popcountll(words[w].bits[i] ^ descriptor.bits[i]);
    if (distance < best_distance) {
      best_distance = distance;
      best = w;
    }
  }
  return best;
}

/// Inverted file with weights normalized per keyframe.
inline void add_inverted_file(MapData* map) {
  map->inverted_file.assign(map->words.size(), {});
  if (map->words.empty()) return;
  std::vector<std::vector<std::uint32_t>> words_of_landmark;
  for (const auto& landmark : map->landmarks) {
    auto& words = words_of_landmark.emplace_back();
    for (const auto& descriptor : landmark.descriptors) words.push_back(nearest_word(map->words, descriptor));
  }
  for (std::size_t k = 0; k < map->keyframes.size(); ++k) {
    std::map<std::uint32_t, double> counts;
    for (const auto landmark : map->keyframes[k].landmarks) {
      for (const auto word : words_of_landmark[landmark]) ++counts[word];
    }
    double squared = 0;
    for (const auto& [word, count] : counts) squared += count * count;
    for (const auto& [word, count] : counts) {
      const double weight = std::max(1.0, std::round(255 * count / std::sqrt(squared)));
      map->inverted_file[word].push_back({static_cast<std::uint16_t>(k), static_cast<std::uint8_t>(weight)});
    }
  }
}

inline MapData make_synthetic_map(const SyntheticMapOptions& options = {}) {
  Random random(options.seed);
  MapData map;
  map.name = "synthetic";
  map.camera = synthetic_camera();
  map.pose_sigma_m = 0.004;
  map.pose_sigma_rad = 0.002;
  for (std::uint32_t i = 0; i < options.num_words; ++i) map.words.push_back(random.descriptor());
  for (std::uint32_t i = 0; i < options.num_landmarks; ++i) { map.landmarks.push_back(synthetic_landmark(options, map.words, &random)); }
  for (std::uint32_t i = 0; i < options.num_keyframes; ++i) {
    MapKeyframe keyframe;
    keyframe.T_map_camera.rotation = random.rotation();
    keyframe.T_map_camera.translation = 4 * random.direction();
    std::vector<bool> is_seen(options.num_landmarks);
    for (std::uint32_t n = 0; n < std::min(options.landmarks_per_keyframe, options.num_landmarks);) {
      const std::uint32_t landmark = random.below(options.num_landmarks);
      if (is_seen[landmark]) continue;
      is_seen[landmark] = true;
      ++n;
    }
    for (std::uint32_t l = 0; l < options.num_landmarks; ++l) {
      if (is_seen[l]) keyframe.landmarks.push_back(l);
    }
    map.keyframes.push_back(std::move(keyframe));
  }
  add_inverted_file(&map);
  if (options.has_wcs) {
    WcsDatum datum;
    datum.T_wcs_map = {random.rotation(), {1000.5, -200.25, 12}};
    datum.covariance.diagonal() << 0.01, 0.01, 0.02, 1e-4, 1e-4, 2e-4;
    map.wcs = datum;
  }
  return map;
}

/// A folder that is gone at the end.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "camloc_test_XXXXXX").string();
    path_ = ::mkdtemp(name.data());
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  [[nodiscard]] std::string file(const std::string& name) const { return (path_ / name).string(); }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

inline void write_bytes(const std::string& path, std::span<const std::byte> bytes) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

inline std::vector<std::byte> read_bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::vector<char> chars{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  std::vector<std::byte> bytes(chars.size());
  if (!chars.empty()) std::memcpy(bytes.data(), chars.data(), chars.size());
  return bytes;
}

/// The table entry of a core section.
inline map_format::SectionRecord section_record(std::span<const std::byte> bytes, map_format::SectionId id) {
  map_format::SectionRecord record;
  const std::size_t offset = sizeof(map_format::FileHeader) + static_cast<std::size_t>(id) * sizeof record;
  std::memcpy(&record, bytes.data() + offset, sizeof record);
  return record;
}

/// Makes all hashes right again after bytes were changed, as far as the section table allows: what a malicious writer
/// would do. Sections whose place makes no sense keep their hash.
inline void reseal(std::span<std::byte> bytes) {
  using namespace map_format;
  FileHeader header;
  if (bytes.size() < sizeof header) return;
  std::memcpy(&header, bytes.data(), sizeof header);
  if (header.num_sections > kMaxSections) return;
  const std::size_t table_end = first_section_offset(header.num_sections);
  if (bytes.size() < table_end) return;
  for (std::size_t i = 0; i < header.num_sections; ++i) {
    SectionRecord record = section_record(bytes, static_cast<SectionId>(i));
    const std::uint64_t padded = (record.num_elements * record.element_bytes + kAlignment - 1) & ~(kAlignment - 1);
    if (record.offset > bytes.size() || padded > bytes.size() - record.offset) continue;
    record.hash = map_hash(bytes.subspan(record.offset, padded));
    std::memcpy(bytes.data() + sizeof(FileHeader) + i * sizeof record, &record, sizeof record);
  }
  header.map_id = map_hash(bytes.subspan(sizeof header, table_end - sizeof header));
  std::memcpy(bytes.data(), &header, sizeof header);
  header.header_hash = map_hash(bytes.first(offsetof(FileHeader, header_hash)));
  std::memcpy(bytes.data(), &header, sizeof header);
}

}  // namespace camloc::testing
