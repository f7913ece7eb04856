// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Keyframes of a generated world at true poses, for the tests of what works on a map.
#pragma once

#include <utility>

#include "core/slam/keyframe_insertion.h"
#include "tests/slam/generated_walk.h"

namespace camloc::testing {

/// Keyframes at true poses.
struct TrueKeyframes {
  World world;
  Viewer viewer{world};
  SlamMap map{viewer.camera(), 1.2F, 8};
  PoseSolver solver{viewer.camera(), map.levels(), mapping_solver_options(600)};
  std::vector<std::vector<std::uint32_t>> shown;

  explicit TrueKeyframes(World w) : world(std::move(w)) {}
  std::uint32_t add(const Rigid3& T, std::uint32_t segment = 0) {
    const auto frame = static_cast<std::uint64_t>(shown.size());
    FrameFeatures view = viewer.see(frame, T);
    view.T_map_camera = T;
    shown.push_back(viewer.shown());
    return insert_keyframe(frame, segment, view, {}, &map);
  }
  /// Are all observations of the landmark of the same point?
  [[nodiscard]] bool is_one_point(const SlamLandmark& landmark) const {
    return std::all_of(landmark.observations.begin(), landmark.observations.end(),
                       [&](const Observation& s) { return point(s) == point(landmark.observations[0]); });
  }
  [[nodiscard]] std::uint32_t point(const Observation& s) const { return shown[s.keyframe][s.feature]; }
};

/// A hall of 14 m, of which the depth camera reaches 4.5.
inline World make_hall() {
  std::mt19937_64 rng(3);
  World world;
  add_room(rng, {-2, -2.5, 0}, {12, 2.5, 3}, 100, &world);
  return world;
}

}  // namespace camloc::testing
