// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/localize/place_grouping.h"

#include <algorithm>

#include "core/registration/rivals.h"

namespace camloc {

PlaceGrouping::PlaceGrouping(const ProposerContext& context) : map_(context.map), numbers_(context.numbers) {
  places_.reserve(static_cast<std::size_t>(std::max(0, numbers_->max_places)));
}

void PlaceGrouping::add(std::uint32_t keyframe) {
  const Rigid3 T_map_view = map_->keyframe_pose(keyframe);
  const auto is_near = [&](const Proposal& place) {
    return !are_rivals(T_map_view, map_->keyframe_pose(place.keyframes[0]), {numbers_->place_radius_m, numbers_->place_angle_rad});
  };
  auto place = std::find_if(places_.begin(), places_.end(), is_near);
  if (place == places_.end()) {
    if (static_cast<int>(places_.size()) >= numbers_->max_places) return;
    place = places_.insert(places_.end(), Proposal{});
  }
  if (place->num_keyframes < std::min(numbers_->max_keyframes_per_place, Proposal::kMaxKeyframes))
    place->keyframes[static_cast<std::size_t>(place->num_keyframes++)] = keyframe;
}

}  // namespace camloc
