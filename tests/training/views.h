// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A wall with blobs of light, and a camera that looks at it.
#pragma once

#include <cmath>

#include "tools/training/training_set.h"

namespace camloc::training {

inline RgbdCamera test_camera() {
  RgbdCamera camera;
  camera.color = {.width = 320, .height = 240, .fx = 260, .fy = 260, .cx = 161, .cy = 118};
  camera.depth = camera.color;
  return camera;
}

inline NetworkInputLayout small_layout() {
  return {.channels = 1, .width = 128, .height = 96, .focal_px = 115, .mean = 115, .scale = 1.0F / 58};
}

/// The wall is 2 m before the map's origin; what is seen of it, grey levels and millimetres.
class WallView {
 public:
  explicit WallView(const Rigid3& T_map_camera, std::uint64_t index = 0) {
    const RgbdCamera camera = test_camera();
    buffer_.sequence = index;
    buffer_.gray.resize(camera.color.width, camera.color.height);
    buffer_.depth.resize(camera.color.width, camera.color.height);
    for (int v = 0; v < camera.color.height; ++v) {
      for (int u = 0; u < camera.color.width; ++u) {
        const Eigen::Vector3d ray((u - camera.color.cx) / camera.color.fx, (v - camera.color.cy) / camera.color.fy, 1);
        const Eigen::Vector3d direction = T_map_camera.rotation * ray;
        const double z = (2 - T_map_camera.translation.z()) / direction.z();
        const Eigen::Vector3d p = T_map_camera.translation + z * direction;
        buffer_.gray.at(u, v) = static_cast<std::uint8_t>(127 + 60 * std::sin(2.3 * p.x() + 1) * std::cos(1.9 * p.y()) +
                                                          50 * std::sin(0.9 * p.x() - 1.3 * p.y()));
        buffer_.depth.at(u, v) = static_cast<std::uint16_t>(std::lround(1000 * z));
      }
    }
  }
  [[nodiscard]] Frame frame() const { return buffer_.view(); }

 private:
  FrameBuffer buffer_;
};

/// `count` poses on a wavy path before the wall.
inline Rigid3 pose_on_path(int i, int count) {
  const double t = 2 * M_PI * i / count;
  return {exp_so3({0.05 * std::sin(3 * t), 0.15 * std::cos(t), 0.04 * std::sin(2 * t)}),
          {0.6 * std::sin(t), 0.3 * std::sin(2 * t), 0.2 * std::cos(t)}};
}

inline TrainingSet walk_before_wall(int count, bool has_depth = false) {
  NetworkInputLayout layout = small_layout();
  if (has_depth) layout.channels = 2;
  TrainingSet set(test_camera(), layout, has_depth);
  for (int i = 0; i < count; ++i)
    set.add(WallView(pose_on_path(i, count), static_cast<std::uint64_t>(i)).frame(), pose_on_path(i, count), 0);
  return set;
}

}  // namespace camloc::training
