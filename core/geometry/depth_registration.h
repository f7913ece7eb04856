// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Depth for colour pixels from two cameras side by side, looked up per keypoint: registering the whole image (z-buffered) takes 7 ms.
#pragma once

#include "core/base/frame.h"
#include "core/geometry/camera.h"

namespace camloc {

/// Depth along the colour camera's z axis at a colour pixel, metres, or 0 where there is none. Follows the epipolar
/// line by fixed-point iteration (at most 6 steps from each of two start depths; where both end on a surface the nearer
/// one is what the colour camera sees) and accepts only a depth pixel that projects back to within 1.5 px.
///
/// At a depth edge (the 3x3 neighbourhood spans more than 5 % of the depth plus three sigma of its noise) the value is
/// given only where the pixel is on the foreground: a corner on an occluding contour belongs to the object in front, so a
/// background depth there would be wrong, and no depth is better than a wrong one.
/// Thread-safe; allocates at construction only.
class DepthLookup {
 public:
  explicit DepthLookup(const RgbdCamera& camera);
  [[nodiscard]] float depth_at(ImageView<std::uint16_t> depth, float u, float v) const;

 private:
  [[nodiscard]] float foreground_depth(ImageView<std::uint16_t> depth, int x, int y) const;
  [[nodiscard]] float follow_epipolar_line(ImageView<std::uint16_t> depth, float u, float v, double start_m) const;

  RgbdCamera camera_;
  Eigen::Matrix3d R_color_depth_, R_depth_color_;
  Eigen::Vector3d t_color_depth_, t_depth_color_;
  UndistortionTable color_rays_, depth_rays_;
};

}  // namespace camloc
