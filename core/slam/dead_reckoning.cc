// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/slam/dead_reckoning.h"

#include <algorithm>
#include <cmath>

namespace camloc {
namespace {

constexpr double kMaxLooseness = 20;
constexpr double kViewRangeM = 6.0;  // how far apart two frames of one place may be taken from
// Where tracking was lost, the camera may have moved this far until the next segment began.
constexpr double kReachM = 0.5, kReachMS = 1.5;
constexpr double kLinkM = 0.006, kLinkRad = 0.005;  // what a link of full strength is good for

double looseness_of(std::uint32_t num_shared) { return std::clamp(150.0 / std::max(num_shared, 1U), 1.0, kMaxLooseness); }

}  // namespace

Matrix6d diagonal_covariance(double sigma_m, double sigma_rad) {
  Matrix6d covariance = Matrix6d::Zero();
  covariance.diagonal() << Eigen::Vector3d::Constant(sigma_m * sigma_m), Eigen::Vector3d::Constant(sigma_rad * sigma_rad);
  return covariance;
}

Matrix6d link_covariance(const Rigid3& T_i_j, std::uint32_t num_shared) {
  const double looseness = looseness_of(num_shared);
  return diagonal_covariance(looseness * (kLinkM + 0.01 * T_i_j.translation.norm()), looseness * kLinkRad);
}

void DeadReckoning::note_links(std::uint32_t keyframe) {
  const auto neighbours = map_->covisible(keyframe, 1);
  note_looseness(keyframe, looseness_of(neighbours.empty() ? 0 : neighbours.front().num_shared));
}

void DeadReckoning::note_looseness(std::uint32_t keyframe, double looseness) {
  if (looseness_.size() <= keyframe) looseness_.resize(keyframe + 1, kMaxLooseness);  // the first of a segment has no link
  looseness_[keyframe] = looseness;
}

// Grows with the way between the two, and with every weak link on it.
DeadReckoning::Drift DeadReckoning::drift(std::uint32_t a, std::uint32_t b) const {
  const auto [from, to] = std::minmax(a, b);
  Drift drift{numbers_.loop_drift_m, numbers_.loop_drift_rad};
  double loose = 0;
  for (std::uint32_t k = from + 1; k <= to; ++k) {
    const Rigid3 step = map_->T_map_camera(k - 1).inverse() * map_->T_map_camera(k);
    const double moved_m = step.translation.norm(), turned_rad = rotation_distance_rad(step.rotation, Eigen::Quaterniond::Identity());
    drift.sigma_m += numbers_.loop_drift_per_m * moved_m;
    drift.sigma_rad += numbers_.loop_drift_rad_per_m * moved_m + numbers_.loop_drift_rad_per_rad * turned_rad;
    loose += (looseness_[k] - 1) * (looseness_[k] - 1);
  }
  drift.sigma_m += kLinkM * std::sqrt(loose);
  drift.sigma_rad += kLinkRad * std::sqrt(loose);
  return drift;
}

bool DeadReckoning::may_see(std::uint32_t keyframe, std::uint32_t place) const {
  const Eigen::Vector3d here = map_->T_map_camera(keyframe).translation;
  const Eigen::Vector3d there = map_->T_map_camera(place).translation;
  if (map_->keyframe(place).segment == map_->keyframe(keyframe).segment) {
    const Drift expected = drift(place, keyframe);
    return (here - there).norm() <= kViewRangeM + 3 * expected.sigma_m;
  }
  const SegmentBegin* begin = begin_between(place, keyframe);
  if (begin == nullptr) return true;
  const Rigid3 T_map_lost = map_->T_map_camera(begin->keyframe_before) * begin->T_before_camera;
  const Rigid3 T_map_found = map_->T_map_camera(begin->first_keyframe);
  const bool is_place_before = map_->keyframe(place).segment == map_->keyframe(begin->keyframe_before).segment;
  const double apart = is_place_before ? (there - T_map_lost.translation).norm() - (here - T_map_found.translation).norm()
                                       : (there - T_map_found.translation).norm() - (here - T_map_lost.translation).norm();
  return apart <= kViewRangeM + kReachM + kReachMS * begin->gap_s;
}

const SegmentBegin* DeadReckoning::begin_between(std::uint32_t a, std::uint32_t b) const {
  const std::uint32_t segment_a = map_->keyframe(a).segment, segment_b = map_->keyframe(b).segment;
  for (const SegmentBegin& begin : begins_) {
    if (!begin.has_before) continue;
    const std::uint32_t before = map_->keyframe(begin.keyframe_before).segment, after = map_->keyframe(begin.first_keyframe).segment;
    if ((before == segment_a && after == segment_b) || (before == segment_b && after == segment_a)) return &begin;
  }
  return nullptr;
}

double DeadReckoning::drift_inconsistency(std::uint32_t keyframe, std::uint32_t place, const Rigid3& T_map_keyframe) const {
  const Rigid3 T_map_now = map_->T_map_camera(keyframe);
  if (map_->keyframe(place).segment == map_->keyframe(keyframe).segment) {
    const Drift expected = drift(place, keyframe);
    return std::max((T_map_keyframe.translation - T_map_now.translation).norm() / expected.sigma_m,
                    rotation_distance_rad(T_map_keyframe.rotation, T_map_now.rotation) / expected.sigma_rad);
  }
  const SegmentBegin* begin = begin_between(place, keyframe);
  if (begin == nullptr) return 0;
  const Rigid3 T_correction = T_map_keyframe * T_map_now.inverse();  // from the segment of the keyframe to that of the place
  Eigen::Vector3d lost = map_->T_map_camera(begin->keyframe_before) * begin->T_before_camera.translation;
  Eigen::Vector3d found = map_->T_map_camera(begin->first_keyframe).translation;
  if (map_->keyframe(begin->keyframe_before).segment == map_->keyframe(keyframe).segment)
    lost = T_correction * lost;
  else
    found = T_correction * found;
  return (found - lost).norm() <= kReachM + kReachMS * begin->gap_s ? 0 : 10;
}

}  // namespace camloc
