// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Has this place been seen before? Words propose, and so does the map itself where the drift is small; geometry verifies, and
// look-alikes are sorted out: a place counts when
//   - many landmarks of it fit the frame, with pixels and with depth, spread over the image;
//   - the correction it asks for is possible for the path since then (same segment), or for the time that passed while the
//     camera was lost (the next one);
//   - no other possible place explains the frame nearly as well.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/registration/frame_registration.h"
#include "core/registration/landmark_set.h"
#include "core/slam/dead_reckoning.h"
#include "core/slam/loops/place_index.h"
#include "core/slam/slam_map.h"

namespace camloc {

/// What is asked of a place: its keyframe and those around it, and what they see.
inline constexpr std::size_t kKeyframesPerPlace = 6, kMaxPlaceLandmarks = 3500;

/// An old place as a keyframe of now saw it.
struct LoopMatch {
  std::uint32_t keyframe = 0, place = 0;
  Rigid3 T_place_keyframe;
  Matrix6d covariance = Matrix6d::Identity();  ///< of pose_error(), axes of `place`
  double drift_inconsistency = 0;              ///< of the correction, see DeadReckoning
  Rigid3 T_correction;                         ///< moves the map of now onto the map of then
  Registration registration;
};

class LoopDetector {
 public:
  LoopDetector(const SlamNumbers& numbers, const SlamMap* map, PoseSolver* solver, const DeadReckoning* reckoning)
      : numbers_(numbers), map_(map), solver_(solver), reckoning_(reckoning), place_landmarks_(map->empty_landmark_set()) {}

  /// The place that a keyframe of the map saw again, if there is one without doubt.
  [[nodiscard]] std::optional<LoopMatch> find(std::uint32_t keyframe, const PlaceIndex& places);

 private:
  struct Candidate {
    std::uint32_t place;
    double drift_inconsistency;
    Registration found;
  };
  [[nodiscard]] std::vector<std::uint8_t> linked_keyframes(std::uint32_t keyframe) const;
  [[nodiscard]] std::vector<std::uint32_t> nearby_keyframes(std::uint32_t keyframe, const std::vector<std::uint8_t>& is_linked) const;
  void try_place(std::uint32_t keyframe, std::uint32_t place, bool is_nearby, std::vector<Candidate>* candidates);
  [[nodiscard]] bool has_rival(const Candidate& best, const std::vector<Candidate>& candidates) const;

  SlamNumbers numbers_;
  const SlamMap* map_;
  PoseSolver* solver_;
  const DeadReckoning* reckoning_;
  LandmarkSet place_landmarks_;
};

}  // namespace camloc
