// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Generated truth for dense alignment: thumbnails of the inside of a box with a faint texture.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

#include "core/dense/thumbnail.h"
#include "core/geometry/camera.h"
#include "tests/dense/generated_texture.h"

namespace camloc::testing {

class BoxRenderer {
 public:
  double contrast = 0.08;  ///< of the texture: 1 is about +-60 grey levels
  double vignetting = 0;   ///< share of the light that is missing in the corners
  double grey_noise = 0.3, depth_noise_m = 0.001;

  BoxRenderer(const RgbdCamera& camera, const Eigen::Vector3d& low, const Eigen::Vector3d& high)
      : camera_(camera), low_(low), high_(high) {}

  Thumbnail see(const Rigid3& T_world_camera) {
    Thumbnail view;
    view.cell_px = camera_.color.width / Thumbnail::kColumns;
    view.width = camera_.color.width / view.cell_px;
    view.height = camera_.color.height / view.cell_px;
    for (int y = 0; y < view.height; ++y) {
      for (int x = 0; x < view.width; ++x) add_cell(T_world_camera, x, y, &view);
    }
    return view;
  }

 private:
  void add_cell(const Rigid3& T_world_camera, int x, int y, Thumbnail* view) {
    const Eigen::Vector2d normalized = camera_.color.undistort({(x + 0.5) * view->cell_px - 0.5, (y + 0.5) * view->cell_px - 0.5});
    const Eigen::Vector3d ray = T_world_camera.rotation * normalized.homogeneous();
    double z = 1e9;
    for (int k = 0; k < 3; ++k) {
      const double wall = ray[k] > 0 ? high_[k] : low_[k];
      if (std::abs(ray[k]) > 1e-9) z = std::min(z, (wall - T_world_camera.translation[k]) / ray[k]);
    }
    const Eigen::Vector3d p = (T_world_camera.translation + z * ray) / kTextureUnitM;
    const double texture = texture_.at({p.x() + 0.7 * p.z(), p.y() + 0.4 * p.z()});
    const double light = 1 - vignetting * std::min(normalized.squaredNorm() / 0.53, 1.0);
    std::normal_distribution<double> noise(0, 1);
    const double grey = light * (120 + contrast * texture) + grey_noise * noise(rng_);
    const double depth = z + depth_noise_m * noise(rng_);
    const bool is_in_range = z >= camera_.min_depth_m && z <= camera_.max_depth_m;
    view->grey.push_back(static_cast<std::uint16_t>(std::lround(std::clamp(grey, 0.0, 255.0) / static_cast<double>(Thumbnail::kGreyUnit))));
    view->depth.push_back(is_in_range ? static_cast<std::uint16_t>(std::lround(depth / static_cast<double>(Thumbnail::kDepthUnitM)))
                                      : std::uint16_t{0});
  }

  static constexpr double kTextureUnitM = 0.02;
  RgbdCamera camera_;
  Eigen::Vector3d low_, high_;
  Texture texture_{21};
  std::mt19937_64 rng_{31};
};

}  // namespace camloc::testing
