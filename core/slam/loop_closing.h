// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Has this place been seen before? Words propose, and so does the map itself where the drift is small; geometry verifies, and a second opinion is asked for wherever the answer
// would move the map by more than the drift explains: buildings repeat themselves, and one false loop ruins a map. A loop is
// closed when
//   - many landmarks of the old place fit the view, with pixels and with depth, spread over the image;
//   - the correction it asks for is possible: for the path walked since then in the same segment, for the time that passed
//     between two segments;
//   - no other possible place explains the view nearly as well (a look-alike would);
//   - the keyframes that follow agree on it, unless the correction is within what the drift explains anyway;
//   - the pose graph with it stretches no link between neighbours beyond what their own measurements allow.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/slam/landmark_set.h"
#include "core/slam/place_index.h"
#include "core/slam/pose_graph.h"
#include "core/slam/slam_map.h"
#include "core/slam/view_registration.h"

namespace camloc {

struct LoopOptions {
  std::size_t num_retrieved = 100;       ///< places that look alike
  std::size_t num_candidates = 8;        ///< of those that are possible, asked for geometry
  std::size_t num_nearby = 3;            ///< keyframes that should see the same, by their poses
  double nearby_m = 1.5, nearby_rad = 0.7;
  float nearby_radius_px = 30;           ///< search window there
  std::size_t keyframes_per_place = 6;
  std::size_t max_place_landmarks = 3500;
  std::uint32_t max_shared = 20;         ///< a keyframe with more common landmarks is a neighbour, no loop
  int min_inliers = 40;
  double min_inlier_ratio = 0.4, min_depth_agreement = 0.7, min_spread = 0.15;
  double max_rival_share = 0.6;          ///< inliers of another place, as a share of the best
  double rival_distance_m = 0.5, rival_angle_rad = 0.35;   ///< another place lies at least this far from the best
  // How far dead reckoning may be off after walking some way.
  double drift_m = 0.05, drift_per_m = 0.01;
  double drift_rad = 0.03, drift_rad_per_m = 0.0005, drift_rad_per_rad = 0.01;
  int num_confirmations = 3;             ///< keyframes that must agree where the drift does not explain the correction
  // Where tracking was lost, the camera may have moved this far until the next segment began.
  double reach_m = 0.5, reach_m_s = 1.5;
  int num_confirmations_within_reach = 2;      ///< keyframes that must agree to join a segment with the one before it
  int num_confirmations_out_of_reach = 8;      ///< and any other two segments, over at least min_joined_path_m
  double min_joined_path_m = 2.0;
  double view_range_m = 6.0;                   ///< how far apart two views of one place may be taken from
  double agreement_m = 0.10, agreement_rad = 0.04;
  double max_chi2 = 60;                  ///< of any link of the pose graph, 6 degrees of freedom
};

/// An old place as a keyframe of now saw it.
struct LoopMatch {
  std::uint32_t keyframe = 0, place = 0;
  Rigid3 T_place_keyframe;
  Matrix6d covariance = Matrix6d::Identity();   ///< of pose_error(), axes of `place`
  double strain = 0;      ///< of the correction, see LoopCloser
  Rigid3 T_correction;    ///< moves the map of now onto the map of then
  Registration registration;
};

struct LoopReport {
  bool is_found = false;                       ///< a possible place was seen again
  bool is_closed = false, is_joined = false;   ///< a loop in its segment; two segments became one
  bool is_refused = false;                     ///< confirmed, but the pose graph would have to stretch too far
  std::uint32_t place = 0;
  int num_inliers = 0;
  Rigid3 T_place_keyframe;
  double correction_m = 0, correction_rad = 0;
};

/// How a segment began: where and when tracking had been lost.
struct SegmentBegin {
  std::uint32_t first_keyframe = 0;
  bool has_before = false;
  std::uint32_t keyframe_before = 0;           ///< of the segment before
  Rigid3 T_before_camera;                      ///< last pose known, relative to that keyframe
  double gap_s = 0;
};

class LoopCloser {
 public:
  LoopCloser(const LoopOptions& options, SlamMap* map, ViewRegistration* registration);
  /// A new segment; its number counts these calls.
  void begin_segment(const SegmentBegin& begin) { begins_.push_back(begin); }
  /// The newest keyframe, already in the map. `places` holds all keyframes before it.
  LoopReport consider(std::uint32_t keyframe, const PlaceIndex& places);
  [[nodiscard]] std::uint32_t num_closed() const { return static_cast<std::uint32_t>(edges_.size()); }

 private:
  void note_links(std::uint32_t keyframe);
  [[nodiscard]] std::optional<LoopMatch> find(std::uint32_t keyframe, const PlaceIndex& places);
  struct Candidate {
    std::uint32_t place;
    double strain;
    Registration found;
  };
  void try_place(std::uint32_t keyframe, std::uint32_t place, bool is_nearby, std::vector<Candidate>* candidates);
  [[nodiscard]] std::vector<std::uint32_t> nearby_keyframes(std::uint32_t keyframe, const std::vector<std::uint8_t>& is_linked) const;
  [[nodiscard]] bool is_convincing(const Registration& found) const;
  struct Drift {
    double sigma_m, sigma_rad;
  };
  [[nodiscard]] Drift drift(std::uint32_t from, std::uint32_t to) const;
  /// The correction in units of what dead reckoning may be off; between segments 0 within reach. Above 3 is impossible.
  [[nodiscard]] double strain(std::uint32_t keyframe, std::uint32_t place, const Rigid3& T_map_keyframe) const;
  [[nodiscard]] bool may_see(std::uint32_t keyframe, std::uint32_t place) const;
  [[nodiscard]] const SegmentBegin* begin_between(std::uint32_t a, std::uint32_t b) const;
  [[nodiscard]] bool is_confirmed(double strain) const;
  [[nodiscard]] bool agrees(const LoopMatch& a, const LoopMatch& b) const;
  [[nodiscard]] bool spread_error(const std::vector<LoopMatch>& matches);
  void move_to(const std::vector<Rigid3>& T_map_keyframe);
  void fuse(const std::vector<LoopMatch>& matches);

  LoopOptions options_;
  SlamMap* map_;
  ViewRegistration* registration_;
  LandmarkSet place_landmarks_;
  std::vector<SegmentBegin> begins_;
  std::vector<double> looseness_;      ///< of each keyframe's link to those before it; 1 = strong
  std::vector<LoopMatch> pending_;
  std::vector<PoseGraphEdge> edges_;   ///< of all loops closed so far
};

}  // namespace camloc
