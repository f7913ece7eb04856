// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Read access to a .cmap file through a memory mapping. Everything is validated once in open(); after that there are only
// indexes. Tables that hold indices into other tables (cubes, keyframes, first descriptors, words) are copied at open,
// a few bytes a landmark, and what stays in the file is clamped where it is used: a file overwritten in place while
// mapped gives wrong landmarks (which verification rejects) but never a wild read.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "core/base/result.h"
#include "core/features/descriptor.h"
#include "core/map/map_data.h"
#include "core/map/map_format.h"
#include "core/map/map_sections.h"

namespace camloc {

struct MapInfo {
  std::string path;
  std::string name;
  std::uint64_t map_id = 0;  ///< hash of the content, the same for identical maps
  std::uint64_t file_bytes = 0;
  std::uint32_t version = 0;
  std::uint32_t num_cubes = 0, num_landmarks = 0, num_descriptors = 0, num_keyframes = 0, num_words = 0;
  std::uint32_t max_keyframe_landmarks = 0;  ///< length of the longest keyframe list, to size buffers
  float orb_scale_factor = 1.2F;
  std::uint32_t orb_num_levels = 8;
  double pose_sigma_m = 0, pose_sigma_rad = 0;  ///< see MapData
  RgbdCamera camera;
  std::optional<WcsDatum> wcs;
};

/// Movable, immutable, may be read from several threads.
class MapView {
 public:
  /// Errors: kNotFound, kIo (folder, permission), kCorrupt (truncated, checksum, ranges), kUnsupported (newer version,
  /// other byte order).
  static Result<MapView> open(const std::string& path);
  ~MapView();
  MapView(MapView&&) noexcept;
  MapView& operator=(MapView&&) noexcept;

  [[nodiscard]] const MapInfo& info() const;
  /// True once a page of the file could not be read any more (truncated while mapped); see mapping_guard.h.
  [[nodiscard]] bool is_damaged() const;

  /// All sections, in the order of the file; those without a kind are not known here and were skipped.
  [[nodiscard]] std::span<const MapSection> sections() const;
  /// The bytes of one section, for the file that knows what they mean; empty where the map does not have it. These stay in
  /// the file: whoever indexes with a number from here compares it with the bound first.
  [[nodiscard]] std::span<const std::byte> section(map_format::SectionId id) const;

  [[nodiscard]] std::span<const map_format::CubeRecord> cubes() const;
  [[nodiscard]] std::span<const map_format::LandmarkRecord> landmarks() const;
  [[nodiscard]] std::span<const map_format::KeyframeRecord> keyframes() const;
  [[nodiscard]] std::span<const Descriptor> descriptors() const;  ///< all, ordered by landmark
  [[nodiscard]] std::span<const Descriptor> words() const;

  /// Cube that holds a landmark.
  [[nodiscard]] std::uint32_t cube_of(std::uint32_t landmark) const;
  [[nodiscard]] Eigen::Vector3f position_m(std::uint32_t landmark) const;
  /// Calls visit(LandmarkRecord, Eigen::Vector3f position_m) for each landmark, in the order of the file.
  template <typename Visit>
  void for_each_position(Visit&& visit) const {
    for (const map_format::CubeRecord& cube : cubes()) {
      for (const auto& landmark : landmarks().subspan(cube.first_landmark, cube.num_landmarks)) visit(landmark, position_m(cube, landmark));
    }
  }
  /// Position with the cube already known: the fast way to walk through one.
  [[nodiscard]] static Eigen::Vector3f position_m(const map_format::CubeRecord& cube, const map_format::LandmarkRecord& landmark) {
    const float scale = cube.extent_m * (1.0F / 65535.0F);
    return {cube.origin_m[0] + scale * landmark.position[0], cube.origin_m[1] + scale * landmark.position[1],
            cube.origin_m[2] + scale * landmark.position[2]};
  }
  /// Unit vector from the landmark towards the cameras that mapped it.
  [[nodiscard]] static Eigen::Vector3f direction(const map_format::LandmarkRecord& landmark);
  [[nodiscard]] static float view_cosine(const map_format::LandmarkRecord& landmark) {
    return static_cast<float>(landmark.view_cosine) / 127.5F - 1.0F;
  }
  /// Reference distance of the 8-bit log code, metres.
  [[nodiscard]] static float reference_m(std::uint8_t code);
  [[nodiscard]] static float angle_rad(const map_format::LandmarkRecord& landmark) {
    return static_cast<float>(landmark.angle) * (6.28318530718F / 256.0F);
  }

  [[nodiscard]] std::uint32_t first_descriptor(std::uint32_t landmark) const;
  /// Use this and not LandmarkRecord::num_descriptors, which nobody checks after open.
  [[nodiscard]] std::uint32_t num_descriptors(std::uint32_t landmark) const;
  [[nodiscard]] std::span<const Descriptor> landmark_descriptors(std::uint32_t landmark) const;

  [[nodiscard]] Rigid3 keyframe_pose(std::uint32_t keyframe) const;  ///< T_map_camera
  /// Unpacks the landmarks of a keyframe, ascending, into `out` and returns how many; stops where `out` is full
  /// (MapInfo::max_keyframe_landmarks always suffices).
  [[nodiscard]] std::size_t keyframe_landmarks(std::uint32_t keyframe, std::span<std::uint32_t> out) const;

  /// Inverted file: keyframes that contain a word, and their weights, same length. These stay in the file: whoever
  /// indexes with a keyframe from here compares it with num_keyframes first.
  [[nodiscard]] std::span<const std::uint16_t> word_keyframes(std::uint32_t word) const;
  [[nodiscard]] std::span<const std::uint8_t> word_weights(std::uint32_t word) const;
  /// log(1 + num_keyframes / keyframes with the word): positive even in a map of one keyframe; 0 for an unused word.
  [[nodiscard]] float word_idf(std::uint32_t word) const;

 private:
  struct Impl;
  explicit MapView(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace camloc
