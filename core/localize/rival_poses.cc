// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/localize/rival_poses.h"

#include <algorithm>

#include "core/registration/rivals.h"

namespace camloc {
namespace {

/// Keyframes nearby whose look-alikes count; a turn by one radian is as far as two metres.
constexpr std::size_t kNumNear = 4;
constexpr double kMetresPerRadian = 2.0, kMaxDistance = 3.0;
/// Two keyframes name the same rival with a little difference.
constexpr RivalDistance kSameRival{.position_m = 1.0, .rotation_rad = 0.5};

}  // namespace

RivalPoses::RivalPoses(const MapView& map, const LocalizerNumbers& numbers) : map_(&map), look_alikes_(map) {
  near_.reserve(map.keyframes().size());
  poses_.reserve(static_cast<std::size_t>(std::max(0, numbers.max_rivals)));
}

std::span<const Rigid3> RivalPoses::of(const Rigid3& T_map_camera) {
  poses_.clear();
  near_.clear();
  if (!look_alikes_.is_known()) return poses_;
  for (std::uint32_t k = 0; k < near_.capacity() && k < map_->keyframes().size(); ++k) {
    const Rigid3 T_map_keyframe = map_->keyframe_pose(k);
    const double distance_m = (T_map_keyframe.translation - T_map_camera.translation).norm();
    if (distance_m > kMaxDistance) continue;
    const double distance = distance_m + kMetresPerRadian * rotation_distance_rad(T_map_keyframe.rotation, T_map_camera.rotation);
    if (distance <= kMaxDistance) near_.push_back({distance, k});
  }
  const auto count = static_cast<std::ptrdiff_t>(std::min(near_.size(), kNumNear));
  std::partial_sort(near_.begin(), near_.begin() + count, near_.end(), [](const NearKeyframe& a, const NearKeyframe& b) {
    return a.distance != b.distance ? a.distance < b.distance : a.keyframe < b.keyframe;
  });
  for (const NearKeyframe& near : std::span(near_).first(static_cast<std::size_t>(count))) {
    const Rigid3 T_keyframe_camera = map_->keyframe_pose(near.keyframe).inverse() * T_map_camera;
    for (std::size_t i = 0; i < look_alikes_.num_rivals(near.keyframe); ++i)
      add(look_alikes_.rival(near.keyframe, i).T_map_camera * T_keyframe_camera);
  }
  return poses_;
}

void RivalPoses::add(const Rigid3& T_map_camera) {
  const bool is_there =
      std::any_of(poses_.begin(), poses_.end(), [&](const Rigid3& pose) { return !are_rivals(pose, T_map_camera, kSameRival); });
  if (!is_there && poses_.size() < poses_.capacity()) poses_.push_back(T_map_camera);
}

}  // namespace camloc
