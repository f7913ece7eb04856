// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Where could this be, with no idea beforehand? Retrieves mapped views that look alike, gathers them into places (views
// of the same corner of the building), matches and solves each place on its own, and keeps the best together with its
// strongest rival: a look-alike shows as a rival that explains the image nearly as well.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/features/matcher.h"
#include "core/localize/observations.h"
#include "core/localize/pose_estimator.h"
#include "core/localize/stage_timer.h"
#include "core/map/map_view.h"
#include "core/map/retrieval.h"

namespace camloc {

struct GlobalSearchOptions {
  int num_keyframes = 80;  ///< retrieved: many, or the twin of a look-alike place is not among them
  int max_places = 6;
  int max_keyframes_per_place = 6;
  double place_radius_m = 2.0;   ///< views of one place: camera centres this close
  double place_angle_rad = 1.2;  ///< and viewing directions
  int max_candidates = 8000;     ///< descriptors of one place
  CandidateMatcherOptions matcher;
  /// Up to here a hypothesis is thin: on a repeated texture the matches may split between two poses, so the matches that
  /// it leaves over are asked for another one.
  std::uint32_t thin_inliers = 80;
  double rival_distance_m = 0.25;  ///< a hypothesis farther than this from the best is a rival
  double rival_angle_rad = 0.2;
};

struct GlobalSearchResult {
  PoseHypothesis best;  ///< looked at again, ready for verification
  double margin = 1;    ///< 1 - inliers of the strongest rival / inliers of the best
  int num_places = 0;
  bool has_candidates = false;  ///< retrieval found any view
};

/// Not thread-safe; allocates at construction only.
class GlobalSearch {
 public:
  GlobalSearch(const MapView& map, const OrbOptions& orb, const GlobalSearchOptions& options, StageTimer* timer);
  [[nodiscard]] GlobalSearchResult search(const FrameObservations& frame, PoseEstimator& estimator, std::uint64_t seed);

 private:
  static constexpr int kMaxPlaces = 8;
  struct Place {
    std::array<std::uint32_t, 16> keyframes;
    int num_keyframes = 0;
  };

  void consider(const PoseHypothesis& hypothesis);
  [[nodiscard]] double margin_of(const PoseHypothesis& best) const;
  void gather_places(std::span<const RetrievedKeyframe> retrieved);
  void gather_candidates(const Place& place);
  [[nodiscard]] bool is_same_place(const Rigid3& a, const Rigid3& b) const;

  const MapView* map_;
  GlobalSearchOptions options_;
  Retriever retriever_;
  CandidateMatcher matcher_;
  CandidateSet candidates_;
  std::vector<std::uint32_t> list_;  ///< landmarks of one keyframe
  std::vector<std::uint32_t> visit_of_landmark_;
  std::uint32_t visit_ = 0;
  std::array<Place, kMaxPlaces> places_;
  int num_places_ = 0;
  std::array<PoseHypothesis, 2 * kMaxPlaces> hypotheses_;  ///< of this frame, looked at again
  std::size_t num_hypotheses_ = 0;
  StageTimer* timer_;
};

}  // namespace camloc
