// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A place seen again corrects the map: the error is spread over the loop, what both passes saw becomes one. Buildings repeat
// themselves, and one false loop ruins a map, so a second opinion is asked for wherever the answer would move the map by more
// than the drift explains, and a loop is refused when the pose graph would have to stretch any link between neighbours beyond
// what their own measurements allow.
#pragma once

#include <cstdint>
#include <vector>

#include "core/optimize/pose_graph.h"
#include "core/registration/frame_registration.h"
#include "core/slam/dead_reckoning.h"
#include "core/slam/loops/loop_detection.h"
#include "core/slam/loops/place_index.h"
#include "core/slam/slam_map.h"

namespace camloc {

/// What a keyframe led to.
struct LoopReport {
  bool is_closed = false, is_joined = false;  ///< a loop in its segment; two segments became one
  bool is_refused = false;                    ///< confirmed, but the pose graph would have to stretch too far
};

class LoopCloser {
 public:
  LoopCloser(const SlamNumbers& numbers, SlamMap* map, PoseSolver* solver);
  LoopCloser(const LoopCloser&) = delete;
  LoopCloser& operator=(const LoopCloser&) = delete;

  void begin_segment(const SegmentBegin& begin) { reckoning_.begin_segment(begin); }
  /// A relative pose of two keyframes of one segment that is known otherwise than by common landmarks.
  void add_link(const PoseGraphEdge& link);
  /// A keyframe that is in the map with all it shares with others. `places` holds keyframes that may have been seen before.
  LoopReport consider(std::uint32_t keyframe, const PlaceIndex& places);

 private:
  [[nodiscard]] bool is_confirmed(double drift_inconsistency) const;
  [[nodiscard]] bool agrees(const LoopMatch& a, const LoopMatch& b) const;
  [[nodiscard]] PoseGraph segment_graph(std::uint32_t segment) const;
  [[nodiscard]] bool spread_error(const std::vector<LoopMatch>& matches);
  void move_to(const std::vector<Rigid3>& T_map_keyframe);
  void fuse(const std::vector<LoopMatch>& matches);
  void fuse_surroundings(const LoopMatch& match);

  SlamNumbers numbers_;
  SlamMap* map_;
  PoseSolver* solver_;
  DeadReckoning reckoning_;
  LoopDetector detector_;
  LandmarkSet place_landmarks_;
  std::vector<LoopMatch> pending_;
  std::vector<PoseGraphEdge> edges_;  ///< of all loops closed so far
  std::vector<PoseGraphEdge> links_;  ///< see add_link()
};

}  // namespace camloc
