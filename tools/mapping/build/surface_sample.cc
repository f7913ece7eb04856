// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/mapping/build/surface_sample.h"

namespace camloc::mapping {

std::vector<Eigen::Vector3f> sample_surface(const RgbdCamera& camera, ImageView<std::uint16_t> depth) {
  constexpr int kColumns = 20, kRows = 15;
  std::vector<Eigen::Vector3f> points;
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const int x = (2 * column + 1) * depth.width / (2 * kColumns), y = (2 * row + 1) * depth.height / (2 * kRows);
      const double z = camera.depth_m(depth.at(x, y));
      if (z <= 0) continue;
      const Eigen::Vector2d ray = camera.depth.undistort({x, y});
      points.push_back((camera.T_color_depth * Eigen::Vector3d(z * ray.x(), z * ray.y(), z)).cast<float>());
    }
  }
  return points;
}

}  // namespace camloc::mapping
