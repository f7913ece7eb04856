// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The .cmap file. (To be documented byte by byte here.)
#pragma once

#include <array>
#include <cstdint>

namespace camloc::map_format {

inline constexpr std::uint32_t kVersion = 1;

/// A cube of the map with its own origin: landmark coordinates are 16-bit fractions of its side.
/// p_map = origin + extent * q / 65535. Its landmarks are contiguous.
struct SubmapRecord {
  std::array<float, 3> origin_m;
  float extent_m;
  std::uint32_t first_landmark;
  std::uint32_t num_landmarks;
};

/// Everything about a landmark but its descriptors: 16 bytes.
struct LandmarkRecord {
  std::array<std::uint16_t, 3> position;   ///< fraction of its sub-map's extent
  std::array<std::uint8_t, 2> direction;   ///< octahedral code of the mean direction landmark -> camera, axes of `map`
  std::uint8_t view_cosine;      ///< cosine of the widest angle between that direction and an observation, [-1, 1] -> 0..255
  std::uint8_t min_reference;    ///< smallest and largest reference distance over its observations; the reference
  std::uint8_t max_reference;    ///< distance d * scale_factor^level is where it would be seen on level 0; log code
  std::uint8_t angle;            ///< keypoint orientation where the first descriptor was seen, 2 pi / 256
  std::uint8_t num_observations; ///< frames that saw it, saturating
  std::uint8_t num_descriptors;
  std::uint16_t position_sigma_mm;  ///< scatter of its observations
};
static_assert(sizeof(LandmarkRecord) == 16);

/// One mapped view. Keyframes are the minimum set that covers all landmarks (greedy set cover).
struct KeyframeRecord {
  std::array<float, 4> rotation_wxyz;   ///< of T_map_camera
  std::array<float, 3> position_m;
  std::uint32_t first_landmark_entry;   ///< into the keyframe landmark lists
  std::uint32_t num_landmark_entries;
};

}  // namespace camloc::map_format
