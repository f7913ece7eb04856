// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Views made feature by feature, for the fusion of landmarks.
#pragma once

#include <cstdint>
#include <random>

#include "core/geometry/camera.h"
#include "core/registration/frame_features.h"

namespace camloc {

inline Intrinsics test_intrinsics() {
  Intrinsics k;
  k.width = 640;
  k.height = 480;
  k.fx = k.fy = 525;
  k.cx = 319.5;
  k.cy = 239.5;
  return k;
}

/// With `num_bits` random bits flipped, fewer where one is drawn twice.
inline Descriptor flipped(const Descriptor& original, int num_bits, std::mt19937_64& random) {
  Descriptor descriptor = original;
  for (int i = 0; i < num_bits; ++i) {
    const std::uint64_t bit = random() % 256;
    descriptor.bits[bit / 64] ^= std::uint64_t{1} << (bit % 64);
  }
  return descriptor;
}

inline void add_feature(const Intrinsics& k, const Eigen::Vector2d& pixel, double depth_m, int level, const Descriptor& descriptor,
                        FrameFeatures* view) {
  Keypoint keypoint;
  keypoint.u = static_cast<float>(pixel.x());
  keypoint.v = static_cast<float>(pixel.y());
  keypoint.level = static_cast<std::uint8_t>(level);
  view->features.keypoints.push_back(keypoint);
  view->features.descriptors.push_back(descriptor);
  view->normalized.push_back(k.undistort(pixel).cast<float>());
  view->depth_m.push_back(static_cast<float>(depth_m));
}

/// At (x, y, 0), turned about y.
inline Rigid3 pose(double x, double y, double yaw) { return {exp_so3({0, yaw, 0}), {x, y, 0}}; }

}  // namespace camloc
