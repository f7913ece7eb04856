// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/slam/dense_links.h"

#include <algorithm>

#include "core/slam/dead_reckoning.h"

namespace camloc {

int DenseLinks::add_keyframe(const SlamMap& map, std::uint32_t keyframe, const ViewThumbnail& thumbnail) {
  int num_links = 0;
  const SlamKeyframe& now = map.keyframe(keyframe);
  for (const std::uint32_t step : options_.steps) {
    if (step == 0 || step > recent_.size()) continue;
    const Recent& before = recent_[step - 1];
    if (map.keyframe(before.keyframe).segment != now.segment) continue;
    const Rigid3 T_before_now = map.keyframe(before.keyframe).view.T_map_camera.inverse() * now.view.T_map_camera;
    const Matrix6d prior = diagonal_covariance(options_.prior_sigma_m, options_.prior_sigma_rad);
    const DenseAlignment aligned = aligner_.align(before.thumbnail, thumbnail, T_before_now, prior);
    if (!aligned.is_aligned) continue;
    links_.push_back({before.keyframe, keyframe, aligned.T_a_b, aligned.covariance});
    ++num_links;
  }
  recent_.push_front({keyframe, thumbnail});
  const std::uint32_t longest = options_.steps.empty() ? 0 : *std::max_element(options_.steps.begin(), options_.steps.end());
  if (recent_.size() > longest) recent_.pop_back();
  return num_links;
}

}  // namespace camloc
