// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/localize/observations.h"

#include <algorithm>

namespace camloc {

FrameObservations::FrameObservations(const RgbdCamera& camera, const OrbOptions& orb, bool use_depth)
    : color_(camera.color),
      use_depth_(use_depth),
      extractor_(camera.color.width, camera.color.height, orb),
      rays_(camera.color),
      depth_lookup_(camera),
      grid_(camera.color.width, camera.color.height, orb.num_features),
      features_(&none_) {
  const auto capacity = static_cast<std::size_t>(orb.num_features);
  x_.resize(capacity);
  y_.resize(capacity);
  depth_m_.resize(capacity);
  for (int level = 0; level < orb.num_levels; ++level) sigma_px_.push_back(extractor_.scale_of_level(level));
}

bool FrameObservations::observe(const Frame& frame) {
  features_ = &none_;
  depth_image_ = {};
  if (frame.gray.empty() || frame.gray.width != color_.width || frame.gray.height != color_.height) return false;
  features_ = &extractor_.extract(frame.gray);
  const auto& keypoints = features_->keypoints;
  const std::size_t count = std::min(keypoints.size(), x_.size());
  if (use_depth_) depth_image_ = frame.depth;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector2f ray = rays_.undistort(keypoints[i].u, keypoints[i].v);
    x_[i] = ray.x();
    y_[i] = ray.y();
    depth_m_[i] = depth_at(keypoints[i].u, keypoints[i].v);
  }
  grid_.assign(keypoints);
  return true;
}

}  // namespace camloc
