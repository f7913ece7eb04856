// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// How far the map may be off between two keyframes when nothing but the way from one to the other is known: what a loop may
// correct, and what no look-alike may.
#pragma once

#include <cstdint>
#include <vector>

#include "core/slam/slam_map.h"
#include "core/slam/slam_numbers.h"

namespace camloc {

/// How a segment began: where and when tracking had been lost.
struct SegmentBegin {
  std::uint32_t first_keyframe = 0;
  bool has_before = false;
  std::uint32_t keyframe_before = 0;  ///< of the segment before
  Rigid3 T_before_camera;             ///< last pose known, relative to that keyframe
  double gap_s = 0;
};

/// Covariance of the relative pose of two keyframes that share so many landmarks (pose_error(), metres then radians): the fewer
/// they are, the worse; a handful may be a slip.
[[nodiscard]] Matrix6d link_covariance(const Rigid3& T_i_j, std::uint32_t num_shared);
[[nodiscard]] Matrix6d diagonal_covariance(double sigma_m, double sigma_rad);

class DeadReckoning {
 public:
  DeadReckoning(const SlamNumbers& numbers, const SlamMap* map) : numbers_(numbers), map_(map) {}

  void begin_segment(const SegmentBegin& begin) { begins_.push_back(begin); }
  /// A keyframe is in the map with all it shares with those before; ascending.
  void note_links(std::uint32_t keyframe);
  /// A keyframe is held by a link of another kind, whose error is noted with one that follows.
  void note_bridged(std::uint32_t keyframe) { note_looseness(keyframe, 1); }

  /// A correction of the keyframe's pose by what it sees of a place, in units of what dead reckoning may be off. Between two
  /// segments it is 0 where the camera can have come that far while it was lost, and where nothing is known. Above
  /// kMaxDriftInconsistency it is impossible.
  static constexpr double kMaxDriftInconsistency = 3;
  [[nodiscard]] double drift_inconsistency(std::uint32_t keyframe, std::uint32_t place, const Rigid3& T_map_keyframe) const;
  /// Could the camera have come within sight of that place?
  [[nodiscard]] bool may_see(std::uint32_t keyframe, std::uint32_t place) const;
  /// How the later one of two segments that followed each other began; null where they did not.
  [[nodiscard]] const SegmentBegin* begin_between(std::uint32_t a, std::uint32_t b) const;

 private:
  struct Drift {
    double sigma_m, sigma_rad;
  };
  void note_looseness(std::uint32_t keyframe, double looseness);
  [[nodiscard]] Drift drift(std::uint32_t a, std::uint32_t b) const;

  SlamNumbers numbers_;
  const SlamMap* map_;
  std::vector<SegmentBegin> begins_;
  std::vector<double> looseness_;  ///< of each keyframe's link to those before it; 1 = strong
};

}  // namespace camloc
