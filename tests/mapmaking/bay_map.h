// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A corridor of bays that are alike, as a map.
#pragma once

#include "tests/map/room_map.h"

namespace camloc::testing {

/// Landmarks on the wall y = 2 between two x, in heights 0 to 2.5 m.
inline void add_wall(MapData* map, double from_x, double to_x, int count, Random* random) {
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d p(random->uniform(from_x, to_x), 2, random->uniform(0, 2.5));
    map->landmarks.push_back(room_landmark(p, Eigen::Vector3d(p.x(), 0, 1.25) - p, random));
  }
}

inline MapData empty_map() {
  MapData map;
  map.camera = room_camera();
  return map;
}

/// `num_bays` pieces of 4 m whose landmarks have the same places and, but for some bits, the same descriptors.
inline MapData make_corridor(int num_bays, int bits) {
  MapData bay = empty_map();
  Random random(11);
  add_wall(&bay, 0, 4, 300, &random);
  MapData map = empty_map();
  for (int i = 0; i < num_bays; ++i) {
    for (MapLandmark landmark : bay.landmarks) {
      landmark.position_m.x() += 4.0F * static_cast<float>(i);
      landmark.descriptors[0] = random.noisy(landmark.descriptors[0], bits);
      map.landmarks.push_back(landmark);
    }
  }
  return map;
}

inline std::vector<Rigid3> one_view_a_bay(int num_bays) {
  std::vector<Rigid3> poses;
  for (int i = 0; i < num_bays; ++i) poses.push_back(looking({4.0 * i + 2, -0.5, 1.4}, {0.05, 1, -0.05}));
  return poses;
}

/// With keyframes at `poses` that see what is in view, and words.
inline void set_keyframes(MapData* map, const std::vector<Rigid3>& poses) {
  map->keyframes.clear();
  for (const Rigid3& pose : poses) map->keyframes.push_back({pose, landmarks_in_view(*map, pose)});
  std::vector<Descriptor> descriptors;
  for (const MapLandmark& landmark : map->landmarks) descriptors.push_back(landmark.descriptors[0]);
  map->words = train_vocabulary(descriptors, 64);
  build_inverted_file(map);
}

}  // namespace camloc::testing
