// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A map of the scanned flat, in any frame and size.
#pragma once

#include <cmath>
#include <vector>

#include "tests/map/room_map.h"
#include "tests/mapping/scanned_flat.h"

namespace camloc::mapping {

inline const ScannedFlat& flat() {
  static const ScannedFlat scanned(3);
  return scanned;
}

inline Rigid3 camera_in_flat(int i) {
  return testing::looking({1.5 + 0.8 * i, 2 + 0.1 * (i % 3), 1.5}, {std::cos(0.9 * i), std::sin(0.9 * i), 0});
}

/// Landmarks, and keyframes amid them, moved by T_map_flat and multiplied by `scale`.
inline MapData map_of(const std::vector<Eigen::Vector3d>& landmarks_m, const Rigid3& T_map_flat = {}, double scale = 1) {
  Random random(11);
  MapData map;
  map.camera = testing::room_camera();
  for (const Eigen::Vector3d& p : landmarks_m) {
    map.landmarks.push_back(testing::room_landmark(scale * (T_map_flat * p), T_map_flat.rotation * Eigen::Vector3d(0.1, 0.2, 1), &random));
  }
  for (std::uint32_t i = 0; i < 8; ++i) {
    MapKeyframe keyframe;
    keyframe.T_map_camera = T_map_flat * camera_in_flat(static_cast<int>(i));
    keyframe.T_map_camera.translation *= scale;
    for (std::uint32_t k = i; k < map.landmarks.size(); k += 8) keyframe.landmarks.push_back(k);
    map.keyframes.push_back(std::move(keyframe));
  }
  std::vector<Descriptor> descriptors;
  for (const MapLandmark& landmark : map.landmarks) descriptors.push_back(landmark.descriptors[0]);
  map.words = train_vocabulary(descriptors, 32);
  build_inverted_file(&map);
  return map;
}

inline MapData map_of_flat(const Rigid3& T_map_flat, double scale = 1) { return map_of(flat().landmarks_m, T_map_flat, scale); }

}  // namespace camloc::mapping
