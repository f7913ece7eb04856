// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Depth for colour pixels from two cameras side by side. The frame path looks depth up per keypoint; registering the
// whole image (z-buffered) takes 7 ms and is for offline tools.
#pragma once

#include "core/base/frame.h"
#include "core/geometry/camera.h"

namespace camloc {

/// Depth along the colour camera's z axis at a colour pixel, metres, or 0 where there is none. Follows the epipolar
/// line by fixed-point iteration (at most 6 steps) and accepts only a depth pixel that projects back to within 1.5 px.
class DepthLookup {
 public:
  explicit DepthLookup(const RgbdCamera& camera);
  [[nodiscard]] float depth_at(ImageView<std::uint16_t> depth, float u, float v) const;

 private:
  RgbdCamera camera_;
  UndistortionTable color_rays_;
};

/// Registers a whole depth image into the colour camera: metres per colour pixel, 0 where none, the nearest surface
/// wins. `registered` is resized to the colour image.
void register_depth(const RgbdCamera& camera, ImageView<std::uint16_t> depth, Image<float>* registered);

}  // namespace camloc
