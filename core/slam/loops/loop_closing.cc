// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/slam/loops/loop_closing.h"

#include <algorithm>
#include <optional>

#include "core/slam/keyframe_insertion.h"

namespace camloc {
namespace {

constexpr std::size_t kMaxPending = 8;
constexpr int kConfirmationsWithinReach = 3;  // keyframes that must agree to join a segment with the one before it
constexpr int kConfirmationsOutOfReach = 8;   // and any other two segments, over at least
constexpr double kMinJoinedPathM = 2.0;
constexpr double kAgreementM = 0.10, kAgreementRad = 0.04;  // of two opinions on one loop
constexpr std::uint32_t kMaxPendingGap = 6;                 // keyframes between two opinions on one loop
constexpr std::uint32_t kMinLinkShared = 60;                // landmarks that make two keyframes linked in the pose graph
constexpr float kFuseRadiusPx = 8;

}  // namespace

LoopCloser::LoopCloser(const SlamNumbers& numbers, SlamMap* map, PoseSolver* solver)
    : numbers_(numbers),
      map_(map),
      solver_(solver),
      reckoning_(numbers, map),
      detector_(numbers, map, solver, &reckoning_),
      place_landmarks_(map->empty_landmark_set()) {}

void LoopCloser::add_link(const PoseGraphEdge& link) {
  links_.push_back(link);
  reckoning_.note_bridged(link.j);
}

LoopReport LoopCloser::consider(std::uint32_t keyframe, const PlaceIndex& places) {
  LoopReport report;
  reckoning_.note_links(keyframe);
  std::optional<LoopMatch> match = detector_.find(keyframe, places);
  if (!match) return report;
  const double drift_inconsistency = match->drift_inconsistency;
  std::erase_if(pending_, [&](const LoopMatch& p) { return keyframe > p.keyframe + kMaxPendingGap || !agrees(p, *match); });
  pending_.push_back(std::move(*match));
  if (pending_.size() > kMaxPending) pending_.erase(pending_.begin());
  if (!is_confirmed(drift_inconsistency)) return report;

  const std::vector<LoopMatch> matches = std::move(pending_);
  pending_.clear();
  const LoopMatch& last = matches.back();
  const std::uint32_t now = map_->keyframe(keyframe).segment, then = map_->keyframe(last.place).segment;
  report.is_joined = now != then;
  if (report.is_joined) map_->join_segments(now, then, last.T_correction);
  report.is_closed = spread_error(matches);
  report.is_refused = !report.is_closed && !report.is_joined;
  if (report.is_closed || report.is_joined) fuse(matches);
  return report;
}

// Do the opinions gathered so far suffice?
bool LoopCloser::is_confirmed(double drift_inconsistency) const {
  const LoopMatch& first = pending_.front();
  const LoopMatch& last = pending_.back();
  const auto count = static_cast<int>(pending_.size());
  if (map_->keyframe(last.place).segment == map_->keyframe(last.keyframe).segment)
    return count >= (drift_inconsistency > 1 ? numbers_.loop_confirmations : 1);
  if (reckoning_.begin_between(last.place, last.keyframe) != nullptr) return count >= kConfirmationsWithinReach;
  const double moved_m = (map_->T_map_camera(first.keyframe).translation - map_->T_map_camera(last.keyframe).translation).norm();
  return count >= kConfirmationsOutOfReach && moved_m >= kMinJoinedPathM;
}

// Both move the newer one's keyframe to the same pose.
bool LoopCloser::agrees(const LoopMatch& a, const LoopMatch& b) const {
  if (map_->keyframe(a.place).segment != map_->keyframe(b.place).segment) return false;
  const Rigid3 T_map_now = map_->T_map_camera(b.keyframe);
  const Rigid3 by_a = a.T_correction * T_map_now, by_b = b.T_correction * T_map_now;
  return (by_a.translation - by_b.translation).norm() <= kAgreementM &&
         rotation_distance_rad(by_a.rotation, by_b.rotation) <= kAgreementRad;
}

// The keyframes of a segment with links between those that share landmarks; all others are fixed.
PoseGraph LoopCloser::segment_graph(std::uint32_t segment) const {
  PoseGraph graph;
  for (const SlamKeyframe& keyframe : map_->keyframes()) {
    graph.T_map_pose.push_back(keyframe.view.T_map_camera);
    graph.is_fixed.push_back(keyframe.segment == segment ? 0 : 1);
  }
  *std::find(graph.is_fixed.begin(), graph.is_fixed.end(), 0) = 1;
  for (std::uint32_t k = 1; k < map_->keyframes().size(); ++k) {
    if (map_->keyframe(k).segment != segment) continue;
    bool has_link = false;
    for (const CovisibleKeyframe& c : map_->covisible(k, 1)) {  // most shared first
      if (c.keyframe > k || (has_link && c.num_shared < kMinLinkShared)) continue;
      has_link = true;
      const Rigid3 T_i_j = graph.T_map_pose[c.keyframe].inverse() * graph.T_map_pose[k];
      graph.edges.push_back({c.keyframe, k, T_i_j, link_covariance(T_i_j, c.num_shared)});
    }
  }
  for (const PoseGraphEdge& link : links_) {
    if (map_->keyframe(link.i).segment == segment) graph.edges.push_back(link);
  }
  return graph;
}

// False, and nothing moved, when the new links had to stretch others too far.
bool LoopCloser::spread_error(const std::vector<LoopMatch>& matches) {
  const std::uint32_t segment = map_->keyframe(matches.back().keyframe).segment;
  PoseGraph graph = segment_graph(segment);
  const auto num_links = static_cast<std::ptrdiff_t>(graph.edges.size());
  for (const PoseGraphEdge& edge : edges_) {
    if (map_->keyframe(edge.i).segment == segment) graph.edges.push_back(edge);
  }
  for (const LoopMatch& match : matches) graph.edges.push_back({match.place, match.keyframe, match.T_place_keyframe, match.covariance});
  const PoseGraphReport report = optimize_pose_graph(&graph);
  const auto worst = std::max_element(report.edge_chi2.begin(), report.edge_chi2.begin() + num_links);
  if (num_links > 0 && !(*worst <= numbers_.loop_max_chi2)) return false;
  edges_.insert(edges_.end(), graph.edges.end() - static_cast<std::ptrdiff_t>(matches.size()), graph.edges.end());
  move_to(graph.T_map_pose);
  return true;
}

// Landmarks go with the first keyframe that saw them.
void LoopCloser::move_to(const std::vector<Rigid3>& T_map_keyframe) {
  for (std::uint32_t i = 0; i < map_->landmarks().size(); ++i) {
    SlamLandmark& landmark = map_->landmark(i);
    if (!landmark.is_alive()) continue;
    const std::uint32_t k = landmark.observations.front().keyframe;
    const Rigid3 T_new_old = T_map_keyframe[k] * map_->T_map_camera(k).inverse();
    landmark.position_m = T_new_old * landmark.position_m;
    landmark.direction = T_new_old.rotation * landmark.direction;
  }
  for (std::uint32_t k = 0; k < T_map_keyframe.size(); ++k) map_->keyframe(k).view.T_map_camera = T_map_keyframe[k];
}

// What both sides saw becomes one.
void LoopCloser::fuse(const std::vector<LoopMatch>& matches) {
  for (const LoopMatch& match : matches) {
    for (const LandmarkObservation& pair : match.registration.inliers) {
      const std::int32_t into = map_->resolve(pair.landmark);
      const std::int32_t present = map_->keyframe(match.keyframe).landmark_of_feature[pair.feature];
      if (into == kNoLandmark || present == into) continue;
      if (present != kNoLandmark)
        map_->merge(static_cast<std::uint32_t>(present), static_cast<std::uint32_t>(into));
      else
        map_->add_observation(static_cast<std::uint32_t>(into), {match.keyframe, pair.feature});
    }
  }
  fuse_surroundings(matches.back());
}

// The keyframes around either side of the loop: what the old ones saw is shown to the new ones.
void LoopCloser::fuse_surroundings(const LoopMatch& last) {
  std::vector<std::uint32_t> then = {last.place}, now = {last.keyframe};
  for (const CovisibleKeyframe& c : map_->covisible(last.place, 30)) {
    if (then.size() < kKeyframesPerPlace && c.keyframe + kMaxPendingGap < last.keyframe) then.push_back(c.keyframe);
  }
  for (const CovisibleKeyframe& c : map_->covisible(last.keyframe, 30)) {
    const bool is_then = std::find(then.begin(), then.end(), c.keyframe) != then.end();
    if (now.size() < 2 * kKeyframesPerPlace && !is_then) now.push_back(c.keyframe);
  }
  for (const std::uint32_t k : now) {
    map_->collect_landmarks(then, kMaxPlaceLandmarks, &place_landmarks_);
    fuse_into_keyframe(&place_landmarks_, k, kFuseRadiusPx, solver_, map_);
  }
}

}  // namespace camloc
