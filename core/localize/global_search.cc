// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/localize/global_search.h"

#include <algorithm>
#include <cmath>

namespace camloc {
namespace {

PoseHypothesis solve(const FrameObservations& frame, PoseEstimator& estimator, std::span<const Match> matches, std::uint64_t seed,
                     const Rigid3* T_map_explained) {
  const PoseHypothesis hypothesis = estimator.from_matches(frame, matches, seed, T_map_explained);
  return hypothesis.is_found ? estimator.look_again(frame, hypothesis) : hypothesis;
}

}  // namespace

GlobalSearch::GlobalSearch(const MapView& map, const OrbOptions& orb, const GlobalSearchOptions& options, StageTimer* timer)
    : map_(&map),
      options_(options),
      retriever_(map, orb.num_features),
      matcher_(options.matcher, orb.num_features, static_cast<std::size_t>(options.max_candidates)),
      candidates_(static_cast<std::size_t>(options.max_candidates)),
      list_(map.info().max_keyframe_landmarks),
      visit_of_landmark_(map.landmarks().size(), 0),
      timer_(timer) {
  options_.max_places = std::min(options_.max_places, kMaxPlaces);
  options_.max_keyframes_per_place = std::min(options_.max_keyframes_per_place, static_cast<int>(Place{}.keyframes.size()));
}

GlobalSearchResult GlobalSearch::search(const FrameObservations& frame, PoseEstimator& estimator, std::uint64_t seed) {
  GlobalSearchResult result;
  gather_places(retriever_.retrieve(frame.features().descriptors, options_.num_keyframes));
  result.num_places = num_places_;
  result.has_candidates = num_places_ > 0;
  timer_->finish(Stage::kCandidates);

  num_hypotheses_ = 0;
  for (int i = 0; i < num_places_; ++i) {
    gather_candidates(places_[static_cast<std::size_t>(i)]);
    const auto matches = matcher_.match(frame.features(), candidates_);
    timer_->finish(Stage::kMatch);
    const std::uint64_t place_seed = seed * kMaxPlaces + static_cast<std::uint64_t>(i);
    const PoseHypothesis hypothesis = solve(frame, estimator, matches, place_seed, nullptr);
    if (!hypothesis.is_found) continue;
    consider(hypothesis);
    if (hypothesis.num_inliers < options_.thin_inliers) consider(solve(frame, estimator, matches, place_seed, &hypothesis.T_map_camera));
  }
  for (std::size_t i = 0; i < num_hypotheses_; ++i) {
    if (!result.best.is_found || hypotheses_[i].num_inliers > result.best.num_inliers) result.best = hypotheses_[i];
  }
  result.margin = margin_of(result.best);
  return result;
}

void GlobalSearch::consider(const PoseHypothesis& hypothesis) {
  if (hypothesis.is_found && num_hypotheses_ < hypotheses_.size()) hypotheses_[num_hypotheses_++] = hypothesis;
}

double GlobalSearch::margin_of(const PoseHypothesis& best) const {
  if (!best.is_found || best.num_inliers == 0) return 0.0;
  std::uint32_t rival_inliers = 0;
  for (std::size_t i = 0; i < num_hypotheses_; ++i) {
    if (!is_same_place(hypotheses_[i].T_map_camera, best.T_map_camera)) rival_inliers = std::max(rival_inliers, hypotheses_[i].num_inliers);
  }
  return 1.0 - static_cast<double>(rival_inliers) / best.num_inliers;
}

void GlobalSearch::gather_places(std::span<const RetrievedKeyframe> retrieved) {
  num_places_ = 0;
  for (const RetrievedKeyframe& view : retrieved) {
    const Rigid3 T_map_view = map_->keyframe_pose(view.keyframe);
    bool is_placed = false;
    for (int i = 0; i < num_places_ && !is_placed; ++i) {
      Place& place = places_[static_cast<std::size_t>(i)];
      const Rigid3 T_map_first = map_->keyframe_pose(place.keyframes[0]);
      const bool is_near = (T_map_view.translation - T_map_first.translation).norm() < options_.place_radius_m &&
                           rotation_distance_rad(T_map_view.rotation, T_map_first.rotation) < options_.place_angle_rad;
      if (!is_near) continue;
      is_placed = true;
      if (place.num_keyframes < options_.max_keyframes_per_place) {
        place.keyframes[static_cast<std::size_t>(place.num_keyframes++)] = view.keyframe;
      }
    }
    if (is_placed || num_places_ >= options_.max_places) continue;
    Place& place = places_[static_cast<std::size_t>(num_places_++)];
    place.keyframes[0] = view.keyframe;
    place.num_keyframes = 1;
  }
}

void GlobalSearch::gather_candidates(const Place& place) {
  candidates_.clear();
  ++visit_;
  for (int k = 0; k < place.num_keyframes; ++k) {
    const std::size_t count = map_->keyframe_landmarks(place.keyframes[static_cast<std::size_t>(k)], list_);
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint32_t landmark = list_[i];
      if (visit_of_landmark_[landmark] == visit_) continue;
      visit_of_landmark_[landmark] = visit_;
      const float angle = MapView::angle_rad(map_->landmarks()[landmark]);
      const std::uint32_t first = map_->first_descriptor(landmark);
      const std::uint32_t num = map_->num_descriptors(landmark);
      for (std::uint32_t d = first; d < first + num; ++d) {
        if (!candidates_.add(map_->descriptors()[d], static_cast<std::int32_t>(landmark), angle)) return;
      }
    }
  }
}

bool GlobalSearch::is_same_place(const Rigid3& a, const Rigid3& b) const {
  return (a.translation - b.translation).norm() < options_.rival_distance_m &&
         rotation_distance_rad(a.rotation, b.rotation) < options_.rival_angle_rad;
}

}  // namespace camloc
