// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/slam/map_extract.h"

#include <algorithm>

#include "core/base/order_statistics.h"

namespace camloc {
namespace {

constexpr std::uint32_t kAbsent = MapExtract::kAbsent;
constexpr std::uint32_t kMinShared = 15;  // landmarks that make a keyframe a neighbour

void add_camera(const SlamMap& map, std::uint32_t keyframe, bool is_fixed, MapExtract* extract) {
  extract->camera_of_keyframe[keyframe] = static_cast<std::uint32_t>(extract->keyframes.size());
  extract->keyframes.push_back(keyframe);
  extract->problem.T_map_camera.push_back(map.T_map_camera(keyframe));
  extract->problem.is_camera_fixed.push_back(is_fixed ? 1 : 0);
}

// A landmark with all its observations by cameras of the problem.
void add_landmark(const SlamMap& map, std::uint32_t index, MapExtract* extract) {
  const SlamLandmark& landmark = map.landmark(index);
  const auto number = static_cast<std::uint32_t>(extract->landmarks.size());
  extract->landmarks.push_back(index);
  extract->problem.landmarks_m.push_back(landmark.position_m);
  for (const Observation& s : landmark.observations) {
    const std::uint32_t camera = extract->camera_of_keyframe[s.keyframe];
    if (camera == kAbsent) continue;
    const FrameFeatures& view = map.keyframe(s.keyframe).view;
    extract->problem.observations.push_back({camera, number, view.normalized[s.feature].x(), view.normalized[s.feature].y(),
                                             view.depth_m[s.feature], map.levels().sigma_px(view.features.keypoints[s.feature].level)});
  }
}

std::uint32_t first_of_segment(const SlamMap& map, std::uint32_t segment) {
  for (std::uint32_t k = 0; k < map.keyframes().size(); ++k) {
    if (map.keyframe(k).segment == segment) return k;
  }
  return kAbsent;
}

// Control landmarks come after those of the map, so that their numbers mean nothing to write_back.
void add_controls(std::span<const ControlLandmark> controls, MapExtract* extract) {
  BundleProblem& problem = extract->problem;
  for (const ControlLandmark& control : controls) {
    const auto number = static_cast<std::uint32_t>(problem.landmarks_m.size());
    const std::size_t before = problem.observations.size();
    for (const ControlLandmark::Seen& seen : control.seen) {
      const std::uint32_t camera = extract->camera_of_keyframe[seen.keyframe];
      if (camera != kAbsent) problem.observations.push_back({camera, number, seen.x, seen.y, seen.depth_m, seen.sigma_px});
    }
    if (problem.observations.size() == before) continue;
    problem.landmarks_m.push_back(control.position_m);
    problem.priors.push_back({number, control.position_m, control.sigma_m});
  }
  if (problem.priors.size() >= 3) problem.is_camera_fixed.assign(extract->keyframes.size(), 0);
}

// Links of the segment's keyframes, with covariances that fit what they are off by now: half of them below the median that six
// degrees of freedom lead to expect.
void add_links(std::span<const PoseGraphEdge> links, MapExtract* extract) {
  constexpr double kMedianChi2 = 5.35;
  BundleProblem& problem = extract->problem;
  std::vector<double> chi2;
  for (PoseGraphEdge link : links) {
    link.i = extract->camera_of_keyframe[link.i];
    link.j = extract->camera_of_keyframe[link.j];
    if (link.i == kAbsent || link.j == kAbsent) continue;
    chi2.push_back(link.linearize({problem.T_map_camera[link.i], problem.T_map_camera[link.j]}).residual.squaredNorm());
    problem.links.push_back(link);
  }
  if (chi2.empty()) return;
  const double excess = std::max(upper_median(std::move(chi2)) / kMedianChi2, 1.0);
  for (PoseGraphEdge& link : problem.links) link.covariance *= excess;
}

}  // namespace

MapExtract extract_window(const SlamNumbers& numbers, std::uint32_t keyframe, const SlamMap& map) {
  MapExtract extract;
  extract.camera_of_keyframe.assign(map.keyframes().size(), kAbsent);
  const std::uint32_t first = first_of_segment(map, map.keyframe(keyframe).segment);
  add_camera(map, keyframe, keyframe == first, &extract);
  for (const CovisibleKeyframe& c : map.covisible(keyframe, kMinShared)) {
    if (extract.keyframes.size() >= numbers.window_free_keyframes) break;
    add_camera(map, c.keyframe, c.keyframe == first, &extract);
  }
  std::vector<std::uint8_t> is_in(map.landmarks().size(), 0);
  std::vector<std::uint32_t> landmarks, num_seen(map.keyframes().size(), 0);
  for (const std::uint32_t k : std::vector(extract.keyframes)) {
    for (const std::int32_t index : map.keyframe(k).landmark_of_feature) {
      if (index == kNoLandmark || is_in[static_cast<std::size_t>(index)] != 0) continue;
      const SlamLandmark& landmark = map.landmark(static_cast<std::uint32_t>(index));
      if (landmark.observations.size() < 2) continue;
      is_in[static_cast<std::size_t>(index)] = 1;
      landmarks.push_back(static_cast<std::uint32_t>(index));
      for (const Observation& s : landmark.observations) ++num_seen[s.keyframe];
    }
  }
  std::vector<std::uint32_t> outside;
  for (std::uint32_t k = 0; k < num_seen.size(); ++k) {
    if (num_seen[k] > 0 && extract.camera_of_keyframe[k] == kAbsent) outside.push_back(k);
  }
  std::stable_sort(outside.begin(), outside.end(), [&](std::uint32_t a, std::uint32_t b) { return num_seen[a] > num_seen[b]; });
  if (outside.size() > numbers.window_fixed_keyframes) outside.resize(numbers.window_fixed_keyframes);
  for (const std::uint32_t k : outside) add_camera(map, k, true, &extract);
  for (const std::uint32_t index : landmarks) add_landmark(map, index, &extract);
  auto& fixed = extract.problem.is_camera_fixed;
  if (std::find(fixed.begin(), fixed.end(), 1) == fixed.end())
    fixed[static_cast<std::size_t>(std::min_element(extract.keyframes.begin(), extract.keyframes.end()) - extract.keyframes.begin())] = 1;
  return extract;
}

MapExtract extract_segment(std::uint32_t segment, const MapEvidence& evidence, const SlamMap& map) {
  MapExtract extract;
  extract.camera_of_keyframe.assign(map.keyframes().size(), kAbsent);
  for (std::uint32_t k = 0; k < map.keyframes().size(); ++k) {
    if (map.keyframe(k).segment == segment) add_camera(map, k, extract.keyframes.empty(), &extract);
  }
  for (std::uint32_t i = 0; i < map.landmarks().size(); ++i) {
    const SlamLandmark& landmark = map.landmark(i);
    if (landmark.observations.size() >= 2 && map.keyframe(landmark.observations.front().keyframe).segment == segment)
      add_landmark(map, i, &extract);
  }
  add_controls(evidence.controls, &extract);
  add_links(evidence.links, &extract);
  return extract;
}

void write_back(const MapExtract& extract, SlamMap* map) {
  for (std::size_t c = 0; c < extract.keyframes.size(); ++c) {
    if (extract.problem.is_camera_fixed[c] != 0) continue;
    SlamKeyframe& keyframe = map->keyframe(extract.keyframes[c]);
    const Rigid3 T_new_old = extract.problem.T_map_camera[c] * keyframe.view.T_map_camera.inverse();
    keyframe.view.T_map_camera = extract.problem.T_map_camera[c];
    for (const std::int32_t index : keyframe.landmark_of_feature) {
      if (index == kNoLandmark) continue;
      SlamLandmark& landmark = map->landmark(static_cast<std::uint32_t>(index));
      if (landmark.observations.size() == 1) landmark.position_m = T_new_old * landmark.position_m;
    }
  }
  for (std::size_t i = 0; i < extract.landmarks.size(); ++i)
    map->landmark(extract.landmarks[i]).position_m = extract.problem.landmarks_m[i];
}

}  // namespace camloc
