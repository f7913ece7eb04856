// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/localize/hint_proposer.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace camloc {
namespace {

constexpr std::int64_t kMaxAgeNs = 3'000'000'000;
/// A view taken this far outside the stated circle, and turned by this, still shows what the camera sees.
constexpr double kViewReachM = 2.0, kViewReachRad = 1.2;

}  // namespace

HintProposer::HintProposer(const ProposerContext& context) : map_(context.map), grouping_(context) {
  near_.reserve(map_->keyframes().size());
}

void HintProposer::on_hint(const PoseHint& hint) {
  if (!hint.is_valid()) return;
  hint_ = hint;
  first_tried_ns_.reset();
}

std::span<const Proposal> HintProposer::propose(const ProposerInput& input) {
  if (!hint_) return {};
  if (!first_tried_ns_) first_tried_ns_ = input.stamp_ns;
  if (std::abs(input.stamp_ns - *first_tried_ns_) > kMaxAgeNs) hint_.reset();
  if (!hint_) return {};
  near_.clear();
  for (std::uint32_t k = 0; k < map_->keyframes().size(); ++k) {
    const Rigid3 T_map_view = map_->keyframe_pose(k);
    const Eigen::Vector3d axis = T_map_view.rotation * Eigen::Vector3d::UnitZ();
    const double distance_m = (T_map_view.translation - hint_->position_m).norm();
    const double turn_rad = std::remainder(std::atan2(axis.y(), axis.x()) - hint_->yaw_rad, 2 * std::numbers::pi);
    if (distance_m <= hint_->radius_m + kViewReachM && std::abs(turn_rad) <= kViewReachRad) near_.push_back({distance_m, k});
  }
  std::sort(near_.begin(), near_.end(), [](const NearKeyframe& a, const NearKeyframe& b) {
    return a.distance_m != b.distance_m ? a.distance_m < b.distance_m : a.keyframe < b.keyframe;
  });
  grouping_.clear();
  for (const NearKeyframe& near : near_) grouping_.add(near.keyframe);
  for (Proposal& place : grouping_.places()) place.overrides_motion = true;
  return grouping_.places();
}

}  // namespace camloc
