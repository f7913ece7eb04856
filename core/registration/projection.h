// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Where a camera sees a landmark, and whether it would know it again: in front of it and inside the image; from an angle that its
// mapped views are near to; on a level of the pyramid that the image has. The inner loop of every look at a map.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/features/matcher.h"
#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "core/registration/keypoint_noise.h"

namespace camloc {

struct ProjectionLimits {
  double min_depth_m = 0.2;
  double max_range_m = 8.0;            ///< along the optical axis
  double view_angle_margin_rad = 0.5;  ///< beyond the widest angle a landmark was mapped from
  int level_margin = 1;                ///< pyramid levels beyond those its observations predict
};

class LandmarkProjector {
 public:
  LandmarkProjector(const Intrinsics& color, const PyramidLevels& levels, const ProjectionLimits& limits);
  /// The camera that the next calls are about.
  void aim(const Rigid3& T_map_camera, float radius_px);

  /// Can any point within `radius_m` of a point, in camera axes, be in view?
  [[nodiscard]] bool may_see(const Eigen::Vector3d& center_camera, double radius_m) const;

  /// A landmark inside the image.
  struct Seen {
    Eigen::Vector3f to_landmark;  ///< from the camera, axes of the map
    float u, v;
  };
  [[nodiscard]] bool is_in_view(const Eigen::Vector3f& p_map, Seen* seen) const {
    seen->to_landmark = p_map - camera_center_;
    const Eigen::Vector3f p_camera = R_camera_map_ * seen->to_landmark;
    if (!(p_camera.z() >= min_depth_m_ && p_camera.z() <= max_range_m_)) return false;
    const float x = p_camera.x() / p_camera.z(), y = p_camera.y() / p_camera.z();
    if (x < min_x_ || x > max_x_ || y < min_y_ || y > max_y_) return false;
    const Eigen::Vector2d pixel = color_.distort({x, y});
    seen->u = static_cast<float>(pixel.x());
    seen->v = static_cast<float>(pixel.y());
    return pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() <= color_.width - 1 && pixel.y() <= color_.height - 1;
  }
  /// `direction`: mean unit vector from the landmark to the cameras that saw it; `widest_cosine`: of the widest angle to it among
  /// them; log_*_reference: of distance * scale of its level, nearest and farthest. Fills all but landmark and descriptors.
  [[nodiscard]] bool is_recognizable(const Seen& seen, const Eigen::Vector3f& direction, float widest_cosine, float log_min_reference,
                                     float log_max_reference, ProjectedLandmark* out) const {
    // cos(a + m) = cos a cos m - sin a sin m.
    const float distance = seen.to_landmark.norm();
    const float limit = widest_cosine * cos_margin_ - std::sqrt(std::max(0.0F, 1.0F - widest_cosine * widest_cosine)) * sin_margin_;
    if (-seen.to_landmark.dot(direction) < limit * distance) return false;
    const float log_distance = std::log(distance);
    const int lowest = static_cast<int>(std::floor((log_min_reference - log_distance) * inverse_log_scale_)) - level_margin_;
    const int highest = static_cast<int>(std::ceil((log_max_reference - log_distance) * inverse_log_scale_)) + level_margin_;
    if (highest < 0 || lowest > max_level_) return false;
    out->u = seen.u;
    out->v = seen.v;
    out->radius_px = radius_px_;
    out->min_level = static_cast<std::uint8_t>(std::max(lowest, 0));
    out->max_level = static_cast<std::uint8_t>(std::min(highest, max_level_));
    return true;
  }

 private:
  Intrinsics color_;
  float min_depth_m_, max_range_m_, cos_margin_, sin_margin_, inverse_log_scale_;
  int level_margin_, max_level_;
  float min_x_ = 0, max_x_ = 0, min_y_ = 0, max_y_ = 0;  ///< of the image's border on the normalized plane: most landmarks end here
  Eigen::Matrix3f R_camera_map_ = Eigen::Matrix3f::Identity();
  Eigen::Vector3f camera_center_ = Eigen::Vector3f::Zero();
  float radius_px_ = 0;
};

}  // namespace camloc
