// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/localize/coarse_proposer.h"

#include <algorithm>
#include <cmath>

namespace camloc {
namespace {

/// A view that was taken so far from the camera, or turned by so much, shows about half of what the camera sees: added to what the
/// hint is uncertain by.
constexpr double kViewReachM = 1.0, kViewReachRad = 0.5;
/// Views farther than this are of elsewhere, if the hint says the truth about itself: 1.1 % of the distances of a six-dimensional
/// normal distribution are larger.
constexpr double kMaxSquaredDistance = 16.0;
/// Of the neighbourhood: the network gives one pose, and each place costs what one of retrieval does.
constexpr std::size_t kMaxPlaces = 3;

double squared_distance(const Rigid3& T_map_hint, const Rigid3& T_map_view, const Matrix6d& covariance) {
  const Vector6d error = pose_error(T_map_hint, T_map_view);
  Vector6d variance = covariance.diagonal();
  variance.head<3>().array() += kViewReachM * kViewReachM;
  variance.tail<3>().array() += kViewReachRad * kViewReachRad;
  return (error.array().square() / variance.array()).sum();
}

}  // namespace

CoarseProposer::CoarseProposer(const ProposerContext& context) : map_(context.map), grouping_(context) {
  near_.reserve(map_->keyframes().size());
}

std::span<const Proposal> CoarseProposer::propose(const ProposerInput& input) {
  if (hint_ && !hint_->is_current(input.stamp_ns)) hint_.reset();
  if (!hint_) return {};
  const Matrix6d covariance = hint_->covariance_at(input.stamp_ns);
  near_.clear();
  for (std::uint32_t k = 0; k < map_->keyframes().size(); ++k) {
    const double distance = squared_distance(hint_->T_map_camera, map_->keyframe_pose(k), covariance);
    if (distance <= kMaxSquaredDistance) near_.push_back({distance, k});
  }
  std::sort(near_.begin(), near_.end(), [](const NearKeyframe& a, const NearKeyframe& b) {
    return a.squared_distance != b.squared_distance ? a.squared_distance < b.squared_distance : a.keyframe < b.keyframe;
  });
  grouping_.clear();
  for (const NearKeyframe& near : near_) grouping_.add(near.keyframe);
  return grouping_.places().first(std::min(grouping_.places().size(), kMaxPlaces));
}

}  // namespace camloc
