// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The features of a frame as measurements: where on the normalized image plane, how far, how sure.
#pragma once

#include <vector>

#include "core/base/frame.h"
#include "core/features/matcher.h"
#include "core/features/orb_extractor.h"
#include "core/geometry/camera.h"
#include "core/geometry/depth_registration.h"

namespace camloc {

/// Allocates at construction only; refilled for every frame.
class FrameObservations {
 public:
  FrameObservations(const RgbdCamera& camera, const OrbOptions& orb, bool use_depth);

  /// Extracts features and measures them. False when the image is empty or not of the camera's size.
  [[nodiscard]] bool observe(const Frame& frame);

  [[nodiscard]] const Features& features() const { return *features_; }
  [[nodiscard]] const FeatureGrid& grid() const { return grid_; }
  [[nodiscard]] std::size_t size() const { return features_->size(); }
  [[nodiscard]] float x(std::size_t i) const { return x_[i]; }  ///< normalized, undistorted
  [[nodiscard]] float y(std::size_t i) const { return y_[i]; }
  [[nodiscard]] float depth_m(std::size_t i) const { return depth_m_[i]; }  ///< along the optical axis, 0 = none
  /// Measured depth at any pixel of the current frame, metres, 0 = none. The frame's pixels must still be there.
  [[nodiscard]] float depth_at(float u, float v) const { return depth_image_.empty() ? 0.0F : depth_lookup_.depth_at(depth_image_, u, v); }
  [[nodiscard]] float sigma_px(std::size_t i) const { return sigma_px_[features_->keypoints[i].level]; }

 private:
  Intrinsics color_;
  bool use_depth_;
  OrbExtractor extractor_;
  UndistortionTable rays_;
  DepthLookup depth_lookup_;
  ImageView<std::uint16_t> depth_image_;
  FeatureGrid grid_;
  const Features* features_;
  Features none_;
  std::vector<float> x_, y_, depth_m_, sigma_px_;
};

}  // namespace camloc
