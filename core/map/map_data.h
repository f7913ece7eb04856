// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A map in memory while it is built, before it is packed into the file. Plain values, no quantization.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/features/descriptor.h"
#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "core/geometry/wcs.h"
#include "core/map/map_format.h"

namespace camloc {

struct MapLandmark {
  Eigen::Vector3f position_m;                      ///< in `map`
  Eigen::Vector3f direction;                       ///< mean unit vector from the landmark to the cameras that saw it
  float view_cosine = 1;                           ///< cosine of the widest angle to that direction
  float min_reference_m = 0, max_reference_m = 0;  ///< distance at which it would be seen on pyramid level 0
  float angle_rad = 0;                             ///< keypoint orientation where descriptors[0] was seen
  float position_sigma_m = 0;                      ///< scatter of its observations
  std::uint32_t num_observations = 0;
  std::vector<Descriptor> descriptors;  ///< at least one; further ones where the appearance differs
};

struct MapKeyframe {
  Rigid3 T_map_camera;
  std::vector<std::uint32_t> landmarks;  ///< indices, ascending
};

struct InvertedEntry {
  std::uint16_t keyframe = 0;
  std::uint8_t weight = 0;  ///< normalized tf-idf of the word in the keyframe, 1..255
};

/// A section beyond the core ones, as bytes. What it says of landmarks it says by their order in the file, which writing an
/// unpacked map keeps; keyframes and words keep their order always.
struct ExtraSection {
  bool is_optional = true;          ///< a reader that does not know it may skip it
  std::uint16_t element_bytes = 1;  ///< at least 1
  std::vector<std::byte> bytes;     ///< whole elements
};

struct MapData {
  std::string name;   ///< free text, at most 63 bytes
  RgbdCamera camera;  ///< that the map was made with
  float orb_scale_factor = 1.2F;
  std::uint32_t orb_num_levels = 8;
  double pose_sigma_m = 0;    ///< what the mapping poses are off by, between views and by the deformation of the map, one
  double pose_sigma_rad = 0;  ///< standard deviation per axis: no pose in this map can be better than that
  std::vector<MapLandmark> landmarks;
  std::vector<MapKeyframe> keyframes;
  std::vector<Descriptor> words;                          ///< vocabulary
  std::vector<std::vector<InvertedEntry>> inverted_file;  ///< per word, keyframes ascending
  std::optional<WcsDatum> wcs;
  /// Written as they are, and unpacked as they are, also by who does not know them. Merging and building start without.
  std::map<map_format::SectionId, ExtraSection> extra_sections;
};

}  // namespace camloc
