// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/slam/loop_closing.h"

#include <algorithm>
#include <cmath>

#include "core/slam/keyframe_insertion.h"

namespace camloc {
namespace {

constexpr std::size_t kMaxPending = 8;
constexpr std::uint32_t kMaxPendingGap = 6;      // keyframes between two opinions on one loop
constexpr std::uint32_t kMinLinkShared = 60;     // landmarks that make two keyframes linked in the pose graph
constexpr float kFuseRadiusPx = 8;
constexpr double kMaxStrain = 3;
constexpr double kMaxLooseness = 20;
constexpr double kLinkM = 0.006, kLinkRad = 0.005;   // what a link of full strength is good for

Matrix6d diagonal_covariance(double sigma_m, double sigma_rad) {
  Matrix6d covariance = Matrix6d::Zero();
  covariance.diagonal() << Eigen::Vector3d::Constant(sigma_m * sigma_m), Eigen::Vector3d::Constant(sigma_rad * sigma_rad);
  return covariance;
}

// The fewer landmarks two keyframes share, the worse they know their relative pose; a handful may be a slip.
double looseness_of(std::uint32_t num_shared) { return std::clamp(150.0 / std::max(num_shared, 1U), 1.0, kMaxLooseness); }

Matrix6d link_covariance(const Rigid3& T_i_j, std::uint32_t num_shared) {
  const double looseness = looseness_of(num_shared);
  return diagonal_covariance(looseness * (kLinkM + 0.01 * T_i_j.translation.norm()), looseness * kLinkRad);
}

Matrix6d turned(const Matrix6d& covariance, const Eigen::Quaterniond& rotation) {
  Matrix6d turn = Matrix6d::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = rotation.toRotationMatrix();
  return turn * covariance * turn.transpose();
}

}  // namespace

LoopCloser::LoopCloser(const LoopOptions& options, SlamMap* map, ViewRegistration* registration)
    : options_(options), map_(map), registration_(registration) {}

LoopReport LoopCloser::consider(std::uint32_t keyframe, const PlaceIndex& places) {
  LoopReport report;
  note_links(keyframe);
  std::optional<LoopMatch> match = find(keyframe, places);
  if (!match) return report;
  report.is_found = true;
  report.place = match->place;
  report.T_place_keyframe = match->T_place_keyframe;
  report.num_inliers = match->registration.num_inliers();
  const double strain = match->strain;
  std::erase_if(pending_, [&](const LoopMatch& p) { return keyframe > p.keyframe + kMaxPendingGap || !agrees(p, *match); });
  pending_.push_back(std::move(*match));
  if (pending_.size() > kMaxPending) pending_.erase(pending_.begin());
  if (!is_confirmed(strain)) return report;

  const std::vector<LoopMatch> matches = std::move(pending_);
  pending_.clear();
  const LoopMatch& last = matches.back();
  const Eigen::Vector3d position = map_->keyframe(keyframe).view.T_map_camera.translation;
  report.correction_m = (last.T_correction * position - position).norm();
  report.correction_rad = rotation_distance_rad(last.T_correction.rotation, Eigen::Quaterniond::Identity());
  const std::uint32_t now = map_->keyframe(keyframe).segment, then = map_->keyframe(last.place).segment;
  report.is_joined = now != then;
  if (report.is_joined) map_->join_segments(now, then, last.T_correction);
  report.is_closed = spread_error(matches);
  report.is_refused = !report.is_closed && !report.is_joined;
  if (report.is_closed || report.is_joined) fuse(matches);
  return report;
}

void LoopCloser::note_links(std::uint32_t keyframe) {
  const auto neighbours = map_->covisible(keyframe, 1);
  if (looseness_.size() <= keyframe) looseness_.resize(keyframe + 1, kMaxLooseness);   // the first of a segment has no link
  looseness_[keyframe] = looseness_of(neighbours.empty() ? 0 : neighbours.front().num_shared);
}

// Do the opinions gathered so far suffice?
bool LoopCloser::is_confirmed(double strain) const {
  const LoopMatch& first = pending_.front();
  const LoopMatch& last = pending_.back();
  const auto count = static_cast<int>(pending_.size());
  if (map_->keyframe(last.place).segment == map_->keyframe(last.keyframe).segment)
    return count >= (strain > 1 ? options_.num_confirmations : 1);
  if (begin_between(last.place, last.keyframe) != nullptr) return count >= options_.num_confirmations_within_reach;
  const double walked = (map_->keyframe(first.keyframe).view.T_map_camera.translation -
                         map_->keyframe(last.keyframe).view.T_map_camera.translation).norm();
  return count >= options_.num_confirmations_out_of_reach && walked >= options_.min_joined_path_m;
}

std::optional<LoopMatch> LoopCloser::find(std::uint32_t keyframe, const PlaceIndex& places) {
  const SlamKeyframe& query = map_->keyframe(keyframe);
  std::vector<std::uint8_t> is_linked(map_->keyframes().size(), 0);
  is_linked[keyframe] = 1;
  for (const CovisibleKeyframe& c : map_->covisible(keyframe, options_.max_shared)) {
    is_linked[c.keyframe] = 1;
    for (const CovisibleKeyframe& next : map_->covisible(c.keyframe, 2 * options_.max_shared)) is_linked[next.keyframe] = 1;
  }
  std::vector<Candidate> candidates;
  for (const std::uint32_t place : nearby_keyframes(keyframe, is_linked)) try_place(keyframe, place, true, &candidates);
  std::size_t num_tried = 0;
  for (const RankedPlace& ranked : places.query(query.view.features.descriptors, options_.num_retrieved)) {
    if (ranked.keyframe >= is_linked.size() || is_linked[ranked.keyframe] != 0 || !may_see(keyframe, ranked.keyframe)) continue;
    if (num_tried++ == options_.num_candidates) break;
    try_place(keyframe, ranked.keyframe, false, &candidates);
  }
  if (candidates.empty()) return std::nullopt;
  auto& best = *std::max_element(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return a.found.num_inliers() < b.found.num_inliers();
  });
  if (!is_convincing(best.found)) return std::nullopt;
  for (const Candidate& other : candidates) {
    const bool is_comparable = map_->keyframe(other.place).segment == map_->keyframe(best.place).segment;
    const bool is_elsewhere =
        (other.found.T_map_camera.translation - best.found.T_map_camera.translation).norm() > options_.rival_distance_m ||
        rotation_distance_rad(other.found.T_map_camera.rotation, best.found.T_map_camera.rotation) > options_.rival_angle_rad;
    if (is_comparable && is_elsewhere && other.found.num_inliers() > options_.max_rival_share * best.found.num_inliers()) return std::nullopt;
  }
  LoopMatch match;
  match.keyframe = keyframe;
  match.place = best.place;
  match.strain = best.strain;
  const Rigid3 T_map_place = map_->keyframe(best.place).view.T_map_camera;
  match.T_place_keyframe = T_map_place.inverse() * best.found.T_map_camera;
  match.covariance = turned(best.found.covariance, T_map_place.rotation.conjugate()) + diagonal_covariance(0.005, 0.002);
  match.T_correction = best.found.T_map_camera * query.view.T_map_camera.inverse();
  match.registration = std::move(best.found);
  return match;
}

// Keyframes of the segment that the poses say look at the same, and that are linked by nothing; nearest first.
std::vector<std::uint32_t> LoopCloser::nearby_keyframes(std::uint32_t keyframe, const std::vector<std::uint8_t>& is_linked) const {
  const SlamKeyframe& here = map_->keyframe(keyframe);
  std::vector<std::pair<double, std::uint32_t>> nearby;
  for (std::uint32_t k = 0; k < map_->keyframes().size(); ++k) {
    const SlamKeyframe& there = map_->keyframe(k);
    if (is_linked[k] != 0 || there.segment != here.segment) continue;
    const double apart_m = (there.view.T_map_camera.translation - here.view.T_map_camera.translation).norm();
    const double turned_rad = rotation_distance_rad(there.view.T_map_camera.rotation, here.view.T_map_camera.rotation);
    if (apart_m <= options_.nearby_m && turned_rad <= options_.nearby_rad) nearby.emplace_back(apart_m + turned_rad, k);
  }
  std::sort(nearby.begin(), nearby.end());
  if (nearby.size() > options_.num_nearby) nearby.resize(options_.num_nearby);
  std::vector<std::uint32_t> result;
  for (const auto& [distance, k] : nearby) result.push_back(k);
  return result;
}

void LoopCloser::try_place(std::uint32_t keyframe, std::uint32_t place, bool is_nearby, std::vector<Candidate>* candidates) {
  std::vector<std::uint32_t> keyframes = {place};
  for (const CovisibleKeyframe& c : map_->covisible(place, 30)) {
    if (keyframes.size() >= options_.keyframes_per_place) break;
    if (c.keyframe != keyframe) keyframes.push_back(c.keyframe);
  }
  place_landmarks_.assign(*map_, keyframes, options_.max_place_landmarks);
  const SlamKeyframe& query = map_->keyframe(keyframe);
  Registration found = is_nearby ? registration_->guided(query.view, &place_landmarks_, query.view.T_map_camera, options_.nearby_radius_px, query.frame)
                                 : registration_->unguided(query.view, &place_landmarks_, query.frame);
  if (!found.is_found) return;
  const double how_strained = strain(keyframe, place, found.T_map_camera);
  if (how_strained <= kMaxStrain) candidates->push_back({place, how_strained, std::move(found)});
}

bool LoopCloser::is_convincing(const Registration& found) const {
  return found.is_found && found.num_inliers() >= options_.min_inliers && found.inlier_ratio() >= options_.min_inlier_ratio &&
         found.depth_agreement >= options_.min_depth_agreement && found.spread >= options_.min_spread;
}

// What dead reckoning from one keyframe to a later one is good for.
LoopCloser::Drift LoopCloser::drift(std::uint32_t from, std::uint32_t to) const {
  Drift drift{options_.drift_m, options_.drift_rad};
  double loose = 0;
  for (std::uint32_t k = from + 1; k <= to; ++k) {
    const Rigid3 step = map_->keyframe(k - 1).view.T_map_camera.inverse() * map_->keyframe(k).view.T_map_camera;
    const double walked = step.translation.norm(), turned_rad = rotation_distance_rad(step.rotation, Eigen::Quaterniond::Identity());
    drift.sigma_m += options_.drift_per_m * walked;
    drift.sigma_rad += options_.drift_rad_per_m * walked + options_.drift_rad_per_rad * turned_rad;
    loose += (looseness_[k] - 1) * (looseness_[k] - 1);
  }
  drift.sigma_m += kLinkM * std::sqrt(loose);
  drift.sigma_rad += kLinkRad * std::sqrt(loose);
  return drift;
}

// Could the camera have come within sight of that place?
bool LoopCloser::may_see(std::uint32_t keyframe, std::uint32_t place) const {
  const Eigen::Vector3d here = map_->keyframe(keyframe).view.T_map_camera.translation;
  const Eigen::Vector3d there = map_->keyframe(place).view.T_map_camera.translation;
  if (map_->keyframe(place).segment == map_->keyframe(keyframe).segment) {
    const Drift expected = drift(std::min(place, keyframe), std::max(place, keyframe));
    return (here - there).norm() <= options_.view_range_m + 3 * expected.sigma_m;
  }
  const SegmentBegin* begin = begin_between(place, keyframe);
  if (begin == nullptr) return true;
  const Rigid3 T_map_lost = map_->keyframe(begin->keyframe_before).view.T_map_camera * begin->T_before_camera;
  const Rigid3 T_map_found = map_->keyframe(begin->first_keyframe).view.T_map_camera;
  const bool is_place_before = map_->keyframe(place).segment == map_->keyframe(begin->keyframe_before).segment;
  const double apart = is_place_before ? (there - T_map_lost.translation).norm() - (here - T_map_found.translation).norm()
                                       : (there - T_map_found.translation).norm() - (here - T_map_lost.translation).norm();
  return apart <= options_.view_range_m + options_.reach_m + options_.reach_m_s * begin->gap_s;
}

// How the later one of two neighbouring segments began.
const SegmentBegin* LoopCloser::begin_between(std::uint32_t a, std::uint32_t b) const {
  const std::uint32_t segment_a = map_->keyframe(a).segment, segment_b = map_->keyframe(b).segment;
  for (const SegmentBegin& begin : begins_) {
    if (!begin.has_before) continue;
    const std::uint32_t before = map_->keyframe(begin.keyframe_before).segment, after = map_->keyframe(begin.first_keyframe).segment;
    if ((before == segment_a && after == segment_b) || (before == segment_b && after == segment_a)) return &begin;
  }
  return nullptr;
}

double LoopCloser::strain(std::uint32_t keyframe, std::uint32_t place, const Rigid3& T_map_keyframe) const {
  const Rigid3 T_map_now = map_->keyframe(keyframe).view.T_map_camera;
  if (map_->keyframe(place).segment == map_->keyframe(keyframe).segment) {
    const Drift expected = drift(std::min(place, keyframe), std::max(place, keyframe));
    return std::max((T_map_keyframe.translation - T_map_now.translation).norm() / expected.sigma_m,
                    rotation_distance_rad(T_map_keyframe.rotation, T_map_now.rotation) / expected.sigma_rad);
  }
  const SegmentBegin* begin = begin_between(place, keyframe);
  if (begin == nullptr) return 0;
  const Rigid3 T_correction = T_map_keyframe * T_map_now.inverse();   // from the segment of the keyframe to that of the place
  Eigen::Vector3d lost = map_->keyframe(begin->keyframe_before).view.T_map_camera * begin->T_before_camera.translation;
  Eigen::Vector3d found = map_->keyframe(begin->first_keyframe).view.T_map_camera.translation;
  if (map_->keyframe(begin->keyframe_before).segment == map_->keyframe(keyframe).segment) lost = T_correction * lost;
  else found = T_correction * found;
  return (found - lost).norm() <= options_.reach_m + options_.reach_m_s * begin->gap_s ? 0 : 10;
}

// Both move the newer one's keyframe to the same pose.
bool LoopCloser::agrees(const LoopMatch& a, const LoopMatch& b) const {
  if (map_->keyframe(a.place).segment != map_->keyframe(b.place).segment) return false;
  const Rigid3 T_map_now = map_->keyframe(b.keyframe).view.T_map_camera;
  const Rigid3 by_a = a.T_correction * T_map_now, by_b = b.T_correction * T_map_now;
  return (by_a.translation - by_b.translation).norm() <= options_.agreement_m &&
         rotation_distance_rad(by_a.rotation, by_b.rotation) <= options_.agreement_rad;
}

// Pose graph over the segment with the new links; false, and nothing moved, when it had to stretch others too far.
bool LoopCloser::spread_error(const std::vector<LoopMatch>& matches) {
  const std::uint32_t segment = map_->keyframe(matches.back().keyframe).segment;
  PoseGraph graph;
  for (const SlamKeyframe& keyframe : map_->keyframes()) {
    graph.T_map_pose.push_back(keyframe.view.T_map_camera);
    graph.is_fixed.push_back(keyframe.segment == segment ? 0 : 1);
  }
  const auto first = std::find(graph.is_fixed.begin(), graph.is_fixed.end(), 0);
  *first = 1;
  const auto link = [&](const CovisibleKeyframe& c, std::uint32_t j) {
    const Rigid3 T_i_j = graph.T_map_pose[c.keyframe].inverse() * graph.T_map_pose[j];
    graph.edges.push_back({c.keyframe, j, T_i_j, link_covariance(T_i_j, c.num_shared)});
  };
  for (std::uint32_t k = 1; k < map_->keyframes().size(); ++k) {
    if (map_->keyframe(k).segment != segment) continue;
    bool has_link = false;
    for (const CovisibleKeyframe& c : map_->covisible(k, kMinLinkShared)) {
      if (c.keyframe < k) link(c, k);
      has_link = has_link || c.keyframe < k;
    }
    if (has_link) continue;
    for (const CovisibleKeyframe& c : map_->covisible(k, 1)) {
      if (c.keyframe > k) continue;
      link(c, k);
      break;
    }
  }
  const std::size_t num_links = graph.edges.size();
  for (const PoseGraphEdge& edge : edges_) {
    if (map_->keyframe(edge.i).segment == segment) graph.edges.push_back(edge);
  }
  for (const LoopMatch& match : matches) graph.edges.push_back({match.place, match.keyframe, match.T_place_keyframe, match.covariance});
  const PoseGraphReport report = optimize_pose_graph({}, &graph);
  const auto worst = std::max_element(report.edge_chi2.begin(), report.edge_chi2.begin() + static_cast<std::ptrdiff_t>(num_links));
  if (num_links > 0 && !(*worst <= options_.max_chi2)) return false;
  for (const LoopMatch& match : matches) edges_.push_back({match.place, match.keyframe, match.T_place_keyframe, match.covariance});
  move_to(graph.T_map_pose);
  return true;
}

// Landmarks go with the first keyframe that saw them.
void LoopCloser::move_to(const std::vector<Rigid3>& T_map_keyframe) {
  for (std::uint32_t i = 0; i < map_->landmarks().size(); ++i) {
    SlamLandmark& landmark = map_->landmark(i);
    if (!landmark.is_alive()) continue;
    const std::uint32_t k = landmark.sightings.front().keyframe;
    const Rigid3 T_new_old = T_map_keyframe[k] * map_->keyframe(k).view.T_map_camera.inverse();
    landmark.position_m = T_new_old * landmark.position_m;
    landmark.direction = T_new_old.rotation * landmark.direction;
  }
  for (std::uint32_t k = 0; k < T_map_keyframe.size(); ++k) map_->keyframe(k).view.T_map_camera = T_map_keyframe[k];
}

// What both sides saw becomes one.
void LoopCloser::fuse(const std::vector<LoopMatch>& matches) {
  for (const LoopMatch& match : matches) {
    for (const RegisteredPair& pair : match.registration.inliers) {
      const std::int32_t into = map_->resolve(pair.landmark);
      const std::int32_t present = map_->keyframe(match.keyframe).landmark_of_feature[pair.feature];
      if (into == kNoLandmark || present == into) continue;
      if (present != kNoLandmark) map_->merge(static_cast<std::uint32_t>(present), static_cast<std::uint32_t>(into));
      else map_->add_sighting(static_cast<std::uint32_t>(into), {match.keyframe, pair.feature});
    }
  }
  const LoopMatch& last = matches.back();
  std::vector<std::uint32_t> then = {last.place}, now = {last.keyframe};
  for (const CovisibleKeyframe& c : map_->covisible(last.place, 30)) {
    if (then.size() < options_.keyframes_per_place && c.keyframe + kMaxPendingGap < last.keyframe) then.push_back(c.keyframe);
  }
  for (const CovisibleKeyframe& c : map_->covisible(last.keyframe, 30)) {
    const bool is_then = std::find(then.begin(), then.end(), c.keyframe) != then.end();
    if (now.size() < 2 * options_.keyframes_per_place && !is_then) now.push_back(c.keyframe);
  }
  for (const std::uint32_t k : now) {
    place_landmarks_.assign(*map_, then, options_.max_place_landmarks);
    fuse_into_keyframe(&place_landmarks_, k, kFuseRadiusPx, registration_, map_);
  }
}

}  // namespace camloc
