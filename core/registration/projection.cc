// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/projection.h"

namespace camloc {
namespace {

/// A lens is not the same everywhere on the border: what is looked at goes this much beyond the sampled points, and never farther
/// than two focal lengths from the axis.
constexpr float kBorderSlack = 0.02F, kMaxNormalized = 2.0F;
constexpr int kBorderSteps = 16;

}  // namespace

LandmarkProjector::LandmarkProjector(const Intrinsics& color, const PyramidLevels& levels, const ProjectionLimits& limits)
    : color_(color),
      min_depth_m_(static_cast<float>(limits.min_depth_m)),
      max_range_m_(static_cast<float>(limits.max_range_m)),
      cos_margin_(static_cast<float>(std::cos(limits.view_angle_margin_rad))),
      sin_margin_(static_cast<float>(std::sin(limits.view_angle_margin_rad))),
      inverse_log_scale_(1.0F / levels.log_scale()),
      level_margin_(limits.level_margin),
      max_level_(levels.num_levels() - 1) {
  for (int i = 0; i <= kBorderSteps; ++i) {
    const double u = static_cast<double>(i) * (color.width - 1) / kBorderSteps,
                 v = static_cast<double>(i) * (color.height - 1) / kBorderSteps;
    for (const Eigen::Vector2d& pixel :
         {Eigen::Vector2d(u, 0), Eigen::Vector2d(u, color.height - 1), Eigen::Vector2d(0, v), Eigen::Vector2d(color.width - 1, v)}) {
      const Eigen::Vector2f border = color.undistort(pixel).cast<float>();
      if (!border.allFinite()) continue;
      min_x_ = std::min(min_x_, border.x() - kBorderSlack);
      max_x_ = std::max(max_x_, border.x() + kBorderSlack);
      min_y_ = std::min(min_y_, border.y() - kBorderSlack);
      max_y_ = std::max(max_y_, border.y() + kBorderSlack);
    }
  }
  min_x_ = std::max(min_x_, -kMaxNormalized);
  max_x_ = std::min(max_x_, kMaxNormalized);
  min_y_ = std::max(min_y_, -kMaxNormalized);
  max_y_ = std::min(max_y_, kMaxNormalized);
}

bool LandmarkProjector::may_see(const Eigen::Vector3d& center, double radius_m) const {
  if (center.z() < -radius_m || center.z() > max_range_m_ + radius_m) return false;
  // Outside one of the four planes through the camera and the image's border by more than the radius?
  const auto is_beyond = [&](double coordinate, double slope) {
    return coordinate - slope * center.z() > radius_m * std::hypot(1.0, slope);
  };
  return !is_beyond(center.x(), max_x_) && !is_beyond(-center.x(), -min_x_) && !is_beyond(center.y(), max_y_) &&
         !is_beyond(-center.y(), -min_y_);
}

void LandmarkProjector::aim(const Rigid3& T_map_camera, float radius_px) {
  R_camera_map_ = T_map_camera.rotation.conjugate().toRotationMatrix().cast<float>();
  camera_center_ = T_map_camera.translation.cast<float>();
  radius_px_ = radius_px;
}

}  // namespace camloc
