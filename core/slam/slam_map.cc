// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/slam/slam_map.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/features/hamming.h"

namespace camloc {
namespace {

// Beyond this many observations the descriptor is chosen from an even sample of them.
constexpr std::size_t kMaxCompared = 12;

bool is_before(const Observation& a, std::uint32_t keyframe) { return a.keyframe < keyframe; }

}  // namespace

SlamMap::SlamMap(const RgbdCamera& camera, float scale_factor, int num_levels) : camera_(camera), levels_(scale_factor, num_levels) {}

std::uint32_t SlamMap::add_keyframe(std::uint64_t frame, std::uint32_t segment, FrameFeatures view) {
  SlamKeyframe& keyframe = keyframes_.emplace_back();
  keyframe.frame = frame;
  keyframe.segment = segment;
  keyframe.landmark_of_feature.assign(view.size(), kNoLandmark);
  keyframe.view = std::move(view);
  return static_cast<std::uint32_t>(keyframes_.size() - 1);
}

std::uint32_t SlamMap::add_landmark(Observation first) {
  const auto index = static_cast<std::uint32_t>(landmarks_.size());
  const FrameFeatures& view = keyframes_[first.keyframe].view;
  assert(view.depth_m[first.feature] > 0);
  landmarks_.emplace_back().position_m = view.T_map_camera * view.point_camera(first.feature);
  add_observation(index, first);
  summarize(index);
  return index;
}

std::uint32_t SlamMap::add_landmark(const Eigen::Vector3d& position_m, Observation first, Observation second) {
  const auto index = static_cast<std::uint32_t>(landmarks_.size());
  landmarks_.emplace_back().position_m = position_m;
  add_observation(index, first);
  add_observation(index, second);
  summarize(index);
  return index;
}

void SlamMap::add_observation(std::uint32_t landmark, Observation observation) {
  SlamKeyframe& keyframe = keyframes_[observation.keyframe];
  auto& observations = landmarks_[landmark].observations;
  const auto place = std::lower_bound(observations.begin(), observations.end(), observation.keyframe, is_before);
  const bool is_seen = place != observations.end() && place->keyframe == observation.keyframe;
  if (is_seen || keyframe.landmark_of_feature[observation.feature] != kNoLandmark) return;
  if (observations.empty()) ++num_alive_;
  observations.insert(place, observation);
  keyframe.landmark_of_feature[observation.feature] = static_cast<std::int32_t>(landmark);
  ++keyframe.num_landmarks;
}

void SlamMap::remove_observation(std::uint32_t landmark, std::uint32_t keyframe) {
  auto& observations = landmarks_[landmark].observations;
  const auto place = std::lower_bound(observations.begin(), observations.end(), keyframe, is_before);
  if (place == observations.end() || place->keyframe != keyframe) return;
  keyframes_[keyframe].landmark_of_feature[place->feature] = kNoLandmark;
  --keyframes_[keyframe].num_landmarks;
  observations.erase(place);
  if (observations.empty()) --num_alive_;
}

void SlamMap::merge(std::uint32_t from, std::uint32_t into) {
  if (from == into) return;
  const std::vector<Observation> moved = landmarks_[from].observations;
  for (const Observation& observation : moved) {
    remove_observation(from, observation.keyframe);
    add_observation(into, observation);
  }
  landmarks_[from].merged_into = static_cast<std::int32_t>(into);
  landmarks_[from].observations.shrink_to_fit();
  summarize(into);
}

std::int32_t SlamMap::resolve(std::uint32_t landmark) const {
  while (landmarks_[landmark].merged_into != kNoLandmark) landmark = static_cast<std::uint32_t>(landmarks_[landmark].merged_into);
  return landmarks_[landmark].is_alive() ? static_cast<std::int32_t>(landmark) : kNoLandmark;
}

float SlamMap::reference_m(const SlamKeyframe& keyframe, std::uint32_t feature, const Eigen::Vector3d& position_m) const {
  const double distance = (position_m - keyframe.view.T_map_camera.translation).norm();
  return static_cast<float>(distance) * levels_.scale(keyframe.view.features.keypoints[feature].level);
}

void SlamMap::summarize(std::uint32_t index) {
  SlamLandmark& landmark = landmarks_[index];
  if (!landmark.is_alive()) return;
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  landmark.min_reference_m = 1e9F;
  landmark.max_reference_m = 0;
  for (const Observation& s : landmark.observations) {
    const SlamKeyframe& keyframe = keyframes_[s.keyframe];
    direction += (keyframe.view.T_map_camera.translation - landmark.position_m).normalized();
    const float reference = reference_m(keyframe, s.feature, landmark.position_m);
    landmark.min_reference_m = std::min(landmark.min_reference_m, reference);
    landmark.max_reference_m = std::max(landmark.max_reference_m, reference);
  }
  landmark.direction = direction.norm() > 1e-9 ? direction.normalized().eval() : Eigen::Vector3d::Zero();

  std::vector<Descriptor> seen;
  const std::size_t step = (landmark.observations.size() + kMaxCompared - 1) / kMaxCompared;
  for (std::size_t i = 0; i < landmark.observations.size(); i += step) {
    const Observation& s = landmark.observations[i];
    seen.push_back(keyframes_[s.keyframe].view.features.descriptors[s.feature]);
  }
  std::uint32_t best = 0xFFFFFFFF;
  std::vector<std::uint16_t> distances(seen.size());
  for (const Descriptor& candidate : seen) {
    hamming_distances(candidate, seen, distances.data());
    std::uint32_t sum = 0;
    for (const std::uint16_t d : distances) sum += d;
    if (sum < best) {
      best = sum;
      landmark.descriptor = candidate;
    }
  }
}

std::vector<CovisibleKeyframe> SlamMap::covisible(std::uint32_t keyframe, std::uint32_t min_shared) const {
  std::vector<std::uint32_t> counts(keyframes_.size(), 0), touched;
  for (const std::int32_t landmark : keyframes_[keyframe].landmark_of_feature) {
    if (landmark == kNoLandmark) continue;
    for (const Observation& s : landmarks_[static_cast<std::size_t>(landmark)].observations) {
      if (counts[s.keyframe]++ == 0) touched.push_back(s.keyframe);
    }
  }
  std::vector<CovisibleKeyframe> result;
  for (const std::uint32_t k : touched) {
    if (k != keyframe && counts[k] >= min_shared) result.push_back({k, counts[k]});
  }
  std::sort(result.begin(), result.end(), [](const CovisibleKeyframe& a, const CovisibleKeyframe& b) {
    return a.num_shared != b.num_shared ? a.num_shared > b.num_shared : a.keyframe < b.keyframe;
  });
  return result;
}

std::vector<std::uint32_t> SlamMap::surroundings(std::uint32_t keyframe, std::uint32_t min_shared, std::size_t max_keyframes) const {
  std::vector<std::uint32_t> keyframes = {keyframe};
  for (const CovisibleKeyframe& c : covisible(keyframe, min_shared)) {
    if (keyframes.size() >= max_keyframes) break;
    keyframes.push_back(c.keyframe);
  }
  return keyframes;
}

void SlamMap::collect_landmarks(std::span<const std::uint32_t> keyframes, std::size_t max_landmarks, LandmarkSet* set) const {
  set->clear();
  std::vector<std::uint8_t> is_in(landmarks_.size(), 0);
  for (const std::uint32_t k : keyframes) {
    for (const std::int32_t index : keyframes_[k].landmark_of_feature) {
      if (index == kNoLandmark || is_in[static_cast<std::size_t>(index)] != 0) continue;
      if (set->size() >= max_landmarks) return;
      is_in[static_cast<std::size_t>(index)] = 1;
      const SlamLandmark& landmark = landmarks_[static_cast<std::size_t>(index)];
      const Observation& first = landmark.observations.front();
      set->add({static_cast<std::uint32_t>(index), landmark.position_m, landmark.direction, landmark.min_reference_m,
                landmark.max_reference_m, keyframes_[first.keyframe].view.features.keypoints[first.feature].angle_rad,
                std::span(&landmark.descriptor, 1)});
    }
  }
}

void SlamMap::join_segments(std::uint32_t from, std::uint32_t into, const Rigid3& T_into_from) {
  for (SlamLandmark& landmark : landmarks_) {
    if (!landmark.is_alive() || keyframes_[landmark.observations.front().keyframe].segment != from) continue;
    landmark.position_m = T_into_from * landmark.position_m;
    landmark.direction = T_into_from.rotation * landmark.direction;
  }
  for (SlamKeyframe& keyframe : keyframes_) {
    if (keyframe.segment != from) continue;
    keyframe.segment = into;
    keyframe.view.T_map_camera = T_into_from * keyframe.view.T_map_camera;
  }
}

}  // namespace camloc
