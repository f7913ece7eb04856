// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/slam/keyframe_insertion.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace camloc {
namespace {

constexpr std::size_t kNumNeighbours = 5;
constexpr float kFuseRadiusPx = 4;
constexpr double kMaxDepthSigmas = 3;
constexpr int kMaxFuseDistance = 50;

}  // namespace

std::uint32_t insert_keyframe(std::uint64_t frame, std::uint32_t segment, const FrameFeatures& view,
                              const std::vector<LandmarkObservation>& tracked, SlamMap* map) {
  const std::uint32_t keyframe = map->add_keyframe(frame, segment, view);
  for (const LandmarkObservation& pair : tracked) {
    const std::int32_t landmark = map->resolve(pair.landmark);
    if (landmark == kNoLandmark) continue;
    map->add_observation(static_cast<std::uint32_t>(landmark), {keyframe, pair.feature});
    map->summarize(static_cast<std::uint32_t>(landmark));
  }
  for (std::uint32_t feature = 0; feature < view.size(); ++feature) {
    if (map->keyframe(keyframe).landmark_of_feature[feature] == kNoLandmark && view.depth_m[feature] > 0)
      map->add_landmark({keyframe, feature});
  }
  return keyframe;
}

int fuse_into_keyframe(LandmarkSet* landmarks, std::uint32_t keyframe, float radius_px, PoseSolver* solver, SlamMap* map) {
  const FrameFeatures& view = map->keyframe(keyframe).view;
  const Rigid3 T_camera_map = view.T_map_camera.inverse();
  int num_fused = 0;
  solver->begin(view);
  for (const Match& match : solver->search_by_projection(landmarks, view.T_map_camera, radius_px)) {
    if (match.distance > kMaxFuseDistance) continue;
    const auto feature = static_cast<std::uint32_t>(match.feature);
    const std::int32_t into = map->resolve(landmarks->id(static_cast<std::size_t>(match.landmark)));
    if (into == kNoLandmark) continue;
    const double depth = view.depth_m[feature];
    const double z = (T_camera_map * map->landmark(static_cast<std::uint32_t>(into)).position_m).z();
    if (depth > 0 && std::abs(z - depth) > kMaxDepthSigmas * map->camera().depth_noise.sigma_m(depth) + 0.01) continue;
    const std::int32_t present = map->keyframe(keyframe).landmark_of_feature[feature];
    if (present == into) continue;
    if (present == kNoLandmark) {
      map->add_observation(static_cast<std::uint32_t>(into), {keyframe, feature});
      map->summarize(static_cast<std::uint32_t>(into));
    } else {
      map->merge(static_cast<std::uint32_t>(present), static_cast<std::uint32_t>(into));
    }
    ++num_fused;
  }
  return num_fused;
}

void fuse_with_neighbours(std::uint32_t keyframe, PoseSolver* solver, SlamMap* map) {
  LandmarkSet own = map->empty_landmark_set();
  map->collect_landmarks(std::array{keyframe}, map->keyframe(keyframe).view.size(), &own);
  const auto neighbours = map->covisible(keyframe, 20);
  for (std::size_t i = 0; i < std::min(kNumNeighbours, neighbours.size()); ++i)
    fuse_into_keyframe(&own, neighbours[i].keyframe, kFuseRadiusPx, solver, map);
}

}  // namespace camloc
