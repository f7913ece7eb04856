// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/slam/dense_links.h"

#include <array>

#include "core/slam/dead_reckoning.h"

namespace camloc {
namespace {

constexpr std::array<std::uint32_t, 2> kSteps{1, 3};          // how many keyframes back, ascending
constexpr double kPriorSigmaM = 0.05, kPriorSigmaRad = 0.05;  // of the keyframes' poses relative to each other

}  // namespace

int DenseLinks::add_keyframe(const SlamMap& map, std::uint32_t keyframe, const Thumbnail& thumbnail) {
  int num_links = 0;
  const SlamKeyframe& now = map.keyframe(keyframe);
  for (const std::uint32_t step : kSteps) {
    if (step > recent_.size()) continue;
    const Recent& before = recent_[step - 1];
    if (map.keyframe(before.keyframe).segment != now.segment) continue;
    const Rigid3 T_before_now = map.T_map_camera(before.keyframe).inverse() * now.view.T_map_camera;
    const Matrix6d prior = diagonal_covariance(kPriorSigmaM, kPriorSigmaRad);
    const DenseAlignment aligned = aligner_.align(before.thumbnail, thumbnail, T_before_now, prior);
    if (!aligned.is_aligned) continue;
    links_.push_back({before.keyframe, keyframe, aligned.T_a_b, aligned.covariance});
    ++num_links;
  }
  recent_.push_front({keyframe, thumbnail});
  if (recent_.size() > kSteps.back()) recent_.pop_back();
  return num_links;
}

}  // namespace camloc
