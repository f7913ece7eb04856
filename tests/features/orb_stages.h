// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The stages of the extractor for keypoints that somebody else has found, cv::ORB for example.
#pragma once

#include <cmath>
#include <vector>

#include "core/features/gaussian_blur.h"
#include "core/features/image_pyramid.h"
#include "core/features/orb_descriptor.h"

namespace camloc {

/// Orientation and descriptor of keypoints (u, v, level are read; angle is set). Those closer than 19 px (of their level) to the
/// border are dropped.
inline Features describe(ImageView<std::uint8_t> image, const std::vector<Keypoint>& keypoints, int num_levels = 8,
                         float scale_factor = 1.2F) {
  ImagePyramid pyramid(image.width, image.height, num_levels, scale_factor);
  pyramid.build(image);
  GaussianBlur blur(image.width);
  std::vector<PaddedImage> blurred(static_cast<std::size_t>(pyramid.num_levels()));
  for (int i = 0; i < pyramid.num_levels(); ++i) {
    PaddedImage& level = blurred[static_cast<std::size_t>(i)];
    level.allocate(pyramid.level(i).width, pyramid.level(i).height);
    blur.apply(pyramid.level(i), &level);
  }
  Features features;
  for (Keypoint keypoint : keypoints) {
    const PaddedImage &level = pyramid.level(keypoint.level), &smooth = blurred[keypoint.level];
    const auto x = static_cast<int>(std::lrint(pyramid.column_on_level(keypoint.level, keypoint.u)));
    const auto y = static_cast<int>(std::lrint(pyramid.row_on_level(keypoint.level, keypoint.v)));
    if (x < kOrbBorder || y < kOrbBorder || x >= level.width - kOrbBorder || y >= level.height - kOrbBorder) continue;
    const float angle_deg = orb_orientation_deg(level.row(y) + x, level.stride);
    keypoint.angle_rad = orb_angle_rad(angle_deg);
    features.keypoints.push_back(keypoint);
    features.descriptors.push_back(orb_descriptor(smooth.row(y) + x, smooth.stride, angle_deg));
  }
  return features;
}

}  // namespace camloc
