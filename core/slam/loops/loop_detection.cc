// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/slam/loops/loop_detection.h"

#include <algorithm>

namespace camloc {
namespace {

constexpr std::size_t kNumRetrieved = 100;  // places that look alike
constexpr std::size_t kNumCandidates = 8;   // of those that are possible, asked for geometry
constexpr std::size_t kNumNearby = 3;       // keyframes that should see the same, by their poses
constexpr float kNearbyRadiusPx = 30;       // search window there
constexpr std::uint32_t kMaxShared = 20;    // a keyframe with more common landmarks is a neighbour, no loop
constexpr PlaceLimits kPlaceLimits;
constexpr std::uint32_t kMinSurroundingShared = 30;  // landmarks that make a keyframe part of a place

}  // namespace

std::optional<LoopMatch> LoopDetector::find(std::uint32_t keyframe, const PlaceIndex& places) {
  const SlamKeyframe& query = map_->keyframe(keyframe);
  const std::vector<std::uint8_t> is_linked = linked_keyframes(keyframe);
  std::vector<Candidate> candidates;
  for (const std::uint32_t place : nearby_keyframes(keyframe, is_linked)) try_place(keyframe, place, true, &candidates);
  std::size_t num_tried = 0;
  for (const RankedKeyframe& ranked : places.query(query.view.features.descriptors, kNumRetrieved)) {
    if (ranked.keyframe >= is_linked.size() || is_linked[ranked.keyframe] != 0 || !reckoning_->may_see(keyframe, ranked.keyframe)) continue;
    if (num_tried++ == kNumCandidates) break;
    try_place(keyframe, ranked.keyframe, false, &candidates);
  }
  const auto best = std::max_element(candidates.begin(), candidates.end(),
                                     [](const Candidate& a, const Candidate& b) { return a.found.num_inliers < b.found.num_inliers; });
  if (best == candidates.end() || !is_convincing(best->found, kPlaceLimits) || has_rival(*best, candidates)) return std::nullopt;
  const Rigid3 T_map_place = map_->T_map_camera(best->place);
  LoopMatch match;
  match.keyframe = keyframe;
  match.place = best->place;
  match.drift_inconsistency = best->drift_inconsistency;
  match.T_place_keyframe = T_map_place.inverse() * best->found.T_map_camera;
  match.covariance = rotate_covariance(T_map_place.rotation.conjugate(), best->found.covariance) + diagonal_covariance(0.005, 0.002);
  match.T_correction = best->found.T_map_camera * query.view.T_map_camera.inverse();
  match.registration = std::move(best->found);
  return match;
}

// The keyframe itself, those it shares landmarks with, and those that these do: nothing of that is a loop.
std::vector<std::uint8_t> LoopDetector::linked_keyframes(std::uint32_t keyframe) const {
  std::vector<std::uint8_t> is_linked(map_->keyframes().size(), 0);
  is_linked[keyframe] = 1;
  for (const CovisibleKeyframe& c : map_->covisible(keyframe, kMaxShared)) {
    is_linked[c.keyframe] = 1;
    for (const CovisibleKeyframe& next : map_->covisible(c.keyframe, 2 * kMaxShared)) is_linked[next.keyframe] = 1;
  }
  return is_linked;
}

// Keyframes of the segment that the poses say look at the same, and that are linked by nothing; nearest first.
std::vector<std::uint32_t> LoopDetector::nearby_keyframes(std::uint32_t keyframe, const std::vector<std::uint8_t>& is_linked) const {
  const SlamKeyframe& here = map_->keyframe(keyframe);
  std::vector<std::pair<double, std::uint32_t>> nearby;
  for (std::uint32_t k = 0; k < map_->keyframes().size(); ++k) {
    const SlamKeyframe& there = map_->keyframe(k);
    if (is_linked[k] != 0 || there.segment != here.segment) continue;
    const double apart_m = (there.view.T_map_camera.translation - here.view.T_map_camera.translation).norm();
    const double turned_rad = rotation_distance_rad(there.view.T_map_camera.rotation, here.view.T_map_camera.rotation);
    if (apart_m <= numbers_.loop_nearby_m && turned_rad <= numbers_.loop_nearby_rad) nearby.emplace_back(apart_m + turned_rad, k);
  }
  std::sort(nearby.begin(), nearby.end());
  if (nearby.size() > kNumNearby) nearby.resize(kNumNearby);
  std::vector<std::uint32_t> result;
  for (const auto& [distance, k] : nearby) result.push_back(k);
  return result;
}

void LoopDetector::try_place(std::uint32_t keyframe, std::uint32_t place, bool is_nearby, std::vector<Candidate>* candidates) {
  const auto keyframes = map_->surroundings(place, kMinSurroundingShared, kKeyframesPerPlace);
  map_->collect_landmarks(keyframes, kMaxPlaceLandmarks, &place_landmarks_);
  const SlamKeyframe& query = map_->keyframe(keyframe);
  Registration found = is_nearby
                           ? register_near(query.view, query.view.T_map_camera, kNearbyRadiusPx, query.frame, &place_landmarks_, solver_)
                           : register_anywhere(query.view, query.frame, &place_landmarks_, solver_);
  if (!found.is_found) return;
  const double drift_inconsistency = reckoning_->drift_inconsistency(keyframe, place, found.T_map_camera);
  if (drift_inconsistency <= DeadReckoning::kMaxDriftInconsistency) candidates->push_back({place, drift_inconsistency, std::move(found)});
}

bool LoopDetector::has_rival(const Candidate& best, const std::vector<Candidate>& candidates) const {
  return std::any_of(candidates.begin(), candidates.end(), [&](const Candidate& other) {
    const bool is_comparable = map_->keyframe(other.place).segment == map_->keyframe(best.place).segment;
    return is_comparable && is_strong_rival(other.found, best.found);
  });
}

}  // namespace camloc
