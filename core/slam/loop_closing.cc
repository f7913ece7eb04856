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

Matrix6d diagonal_covariance(double sigma_m, double sigma_rad) {
  Matrix6d covariance = Matrix6d::Zero();
  covariance.diagonal() << Eigen::Vector3d::Constant(sigma_m * sigma_m), Eigen::Vector3d::Constant(sigma_rad * sigma_rad);
  return covariance;
}

// How well neighbouring keyframes know their relative pose.
Matrix6d link_covariance(const Rigid3& T_i_j) { return diagonal_covariance(0.006 + 0.01 * T_i_j.translation.norm(), 0.004); }

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
  std::optional<LoopMatch> match = find(keyframe, places);
  if (!match) return report;
  const bool is_other_segment = map_->keyframe(match->place).segment != map_->keyframe(keyframe).segment;
  const double drift = is_other_segment ? 0 : drift_ratio(*match);
  report.place = match->place;
  if (drift > 3) {
    report.is_refused = true;
    return report;
  }
  std::erase_if(pending_, [&](const LoopMatch& p) { return keyframe - p.keyframe > kMaxPendingGap || !agrees(p, *match); });
  pending_.push_back(std::move(*match));
  if (pending_.size() > kMaxPending) pending_.erase(pending_.begin());
  const int num_needed = is_other_segment ? options_.num_confirmations_between_segments : drift > 1 ? options_.num_confirmations : 1;
  if (static_cast<int>(pending_.size()) < num_needed) return report;

  const std::vector<LoopMatch> matches = std::move(pending_);
  pending_.clear();
  const LoopMatch& last = matches.back();
  report.correction_m = (last.T_correction * map_->keyframe(keyframe).view.T_map_camera.translation -
                         map_->keyframe(keyframe).view.T_map_camera.translation).norm();
  report.correction_rad = rotation_distance_rad(last.T_correction.rotation, Eigen::Quaterniond::Identity());
  if (is_other_segment) {
    // The older segment keeps its frame.
    const std::uint32_t now = map_->keyframe(keyframe).segment, then = map_->keyframe(last.place).segment;
    map_->join_segments(now, then, last.T_correction);
    report.is_joined = true;
  }
  if (!spread_error(matches)) {
    report.is_refused = !is_other_segment;
    return report;
  }
  fuse(matches);
  report.is_closed = true;
  return report;
}

std::optional<LoopMatch> LoopCloser::find(std::uint32_t keyframe, const PlaceIndex& places) {
  const SlamKeyframe& query = map_->keyframe(keyframe);
  std::vector<std::uint8_t> is_near(map_->keyframes().size(), 0);
  is_near[keyframe] = 1;
  for (const CovisibleKeyframe& c : map_->covisible(keyframe, options_.max_shared)) {
    is_near[c.keyframe] = 1;
    for (const CovisibleKeyframe& next : map_->covisible(c.keyframe, 2 * options_.max_shared)) is_near[next.keyframe] = 1;
  }
  Registration best;
  std::uint32_t best_place = 0;
  int rival_inliers = 0;
  std::vector<std::pair<std::uint32_t, Registration>> found;
  std::size_t num_tried = 0;
  for (const RankedPlace& place : places.query(query.view.features.descriptors, 6 * options_.num_candidates)) {
    if (place.keyframe >= is_near.size() || is_near[place.keyframe] != 0) continue;
    if (num_tried++ == options_.num_candidates) break;
    Registration registered = register_to_place(keyframe, place.keyframe, query.frame);
    if (!registered.is_found) continue;
    if (registered.num_inliers() > best.num_inliers()) {
      best = registered;
      best_place = place.keyframe;
    }
    found.emplace_back(place.keyframe, std::move(registered));
  }
  if (!is_convincing(best)) return std::nullopt;
  for (const auto& [place, other] : found) {
    if (map_->keyframe(place).segment != map_->keyframe(best_place).segment) continue;
    const bool is_elsewhere =
        (other.T_map_camera.translation - best.T_map_camera.translation).norm() > options_.rival_distance_m ||
        rotation_distance_rad(other.T_map_camera.rotation, best.T_map_camera.rotation) > options_.rival_angle_rad;
    if (is_elsewhere) rival_inliers = std::max(rival_inliers, other.num_inliers());
  }
  if (rival_inliers > options_.max_rival_share * best.num_inliers()) return std::nullopt;
  LoopMatch match;
  match.keyframe = keyframe;
  match.place = best_place;
  const Rigid3 T_map_place = map_->keyframe(best_place).view.T_map_camera;
  match.T_place_keyframe = T_map_place.inverse() * best.T_map_camera;
  match.covariance = turned(best.covariance, T_map_place.rotation.conjugate()) + diagonal_covariance(0.005, 0.002);
  match.T_correction = best.T_map_camera * query.view.T_map_camera.inverse();
  match.registration = std::move(best);
  return match;
}

Registration LoopCloser::register_to_place(std::uint32_t keyframe, std::uint32_t place, std::uint64_t seed) {
  std::vector<std::uint32_t> keyframes = {place};
  for (const CovisibleKeyframe& c : map_->covisible(place, 30)) {
    if (keyframes.size() >= options_.keyframes_per_place) break;
    if (c.keyframe != keyframe) keyframes.push_back(c.keyframe);
  }
  place_landmarks_.assign(*map_, keyframes, options_.max_place_landmarks);
  return registration_->unguided(map_->keyframe(keyframe).view, &place_landmarks_, seed);
}

bool LoopCloser::is_convincing(const Registration& found) const {
  return found.is_found && found.num_inliers() >= options_.min_inliers && found.inlier_ratio() >= options_.min_inlier_ratio &&
         found.depth_agreement >= options_.min_depth_agreement && found.spread >= options_.min_spread;
}

double LoopCloser::path_m(std::uint32_t from, std::uint32_t to) const {
  double length = 0;
  for (std::uint32_t k = from + 1; k <= to; ++k)
    length += (map_->keyframe(k).view.T_map_camera.translation - map_->keyframe(k - 1).view.T_map_camera.translation).norm();
  return length;
}

// The correction in units of what the drift explains.
double LoopCloser::drift_ratio(const LoopMatch& match) const {
  const Rigid3 T_map_now = map_->keyframe(match.keyframe).view.T_map_camera;
  const Rigid3 T_map_then = match.T_correction * T_map_now;
  const double walked = path_m(std::min(match.place, match.keyframe), std::max(match.place, match.keyframe));
  const double moved_m = (T_map_then.translation - T_map_now.translation).norm();
  const double moved_rad = rotation_distance_rad(T_map_then.rotation, T_map_now.rotation);
  return std::max(moved_m / (options_.drift_m + options_.drift_per_m * walked),
                  moved_rad / (options_.drift_rad + options_.drift_rad_per_m * walked));
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
  const auto link = [&](std::uint32_t i, std::uint32_t j) {
    const Rigid3 T_i_j = graph.T_map_pose[i].inverse() * graph.T_map_pose[j];
    graph.edges.push_back({i, j, T_i_j, link_covariance(T_i_j)});
  };
  for (std::uint32_t k = 1; k < map_->keyframes().size(); ++k) {
    if (map_->keyframe(k).segment != segment) continue;
    bool has_link = false;
    for (const CovisibleKeyframe& c : map_->covisible(k, kMinLinkShared)) {
      if (c.keyframe < k) link(c.keyframe, k);
      has_link = has_link || c.keyframe < k;
    }
    if (has_link) continue;
    for (const CovisibleKeyframe& c : map_->covisible(k, 1)) {
      if (c.keyframe > k) continue;
      link(c.keyframe, k);
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
