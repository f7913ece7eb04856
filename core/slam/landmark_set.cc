// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/slam/landmark_set.h"

#include <algorithm>
#include <cmath>

namespace camloc {

void LandmarkSet::clear() {
  ids_.clear();
  positions_m_.clear();
  directions_.clear();
  log_min_reference_.clear();
  log_max_reference_.clear();
  angles_rad_.clear();
  descriptors_.clear();
  first_descriptor_.clear();
}

void LandmarkSet::assign(const SlamMap& map, std::span<const std::uint32_t> keyframes, std::size_t max_landmarks) {
  color_ = map.camera().color;
  log_scale_ = std::log(map.scale_of_level(1));
  num_levels_ = map.num_levels();
  clear();
  std::vector<std::uint8_t> is_in(map.landmarks().size(), 0);
  for (const std::uint32_t k : keyframes) {
    for (const std::int32_t index : map.keyframe(k).landmark_of_feature) {
      if (index == kNoLandmark || is_in[static_cast<std::size_t>(index)] != 0) continue;
      if (ids_.size() >= max_landmarks) return;
      is_in[static_cast<std::size_t>(index)] = 1;
      const SlamLandmark& landmark = map.landmark(static_cast<std::uint32_t>(index));
      const Sighting& first = landmark.sightings.front();
      ids_.push_back(static_cast<std::uint32_t>(index));
      positions_m_.push_back(landmark.position_m);
      directions_.push_back(landmark.direction);
      log_min_reference_.push_back(std::log(landmark.min_reference_m));
      log_max_reference_.push_back(std::log(landmark.max_reference_m));
      angles_rad_.push_back(map.keyframe(first.keyframe).view.features.keypoints[first.feature].angle_rad);
      first_descriptor_.push_back(static_cast<std::uint32_t>(descriptors_.size()));
      descriptors_.push_back(landmark.descriptor);
    }
  }
}

void LandmarkSet::assign(const MapData& map, const Intrinsics& color, std::span<const std::uint32_t> landmarks) {
  color_ = color;
  log_scale_ = std::log(map.orb_scale_factor);
  num_levels_ = static_cast<int>(map.orb_num_levels);
  clear();
  for (const std::uint32_t index : landmarks) {
    const MapLandmark& landmark = map.landmarks[index];
    ids_.push_back(index);
    positions_m_.push_back(landmark.position_m.cast<double>());
    directions_.push_back(landmark.direction.cast<double>());
    log_min_reference_.push_back(std::log(landmark.min_reference_m));
    log_max_reference_.push_back(std::log(landmark.max_reference_m));
    angles_rad_.push_back(landmark.angle_rad);
    first_descriptor_.push_back(static_cast<std::uint32_t>(descriptors_.size()));
    descriptors_.insert(descriptors_.end(), landmark.descriptors.begin(), landmark.descriptors.end());
  }
}

std::span<const ProjectedLandmark> LandmarkSet::project(const Rigid3& T_map_camera, float radius_px, const ProjectionLimits& limits) {
  projected_.clear();
  const Eigen::Matrix3d R_camera_map = T_map_camera.rotation.conjugate().toRotationMatrix();
  const double min_cosine = std::cos(limits.max_view_angle_rad);
  for (std::size_t i = 0; i < ids_.size(); ++i) {
    const Eigen::Vector3d from_camera = positions_m_[i] - T_map_camera.translation;
    const Eigen::Vector3d p_camera = R_camera_map * from_camera;
    if (!(p_camera.z() > 0.1 && p_camera.z() < limits.max_range_m)) continue;
    const double x = p_camera.x() / p_camera.z(), y = p_camera.y() / p_camera.z();
    if (std::abs(x) > 2 || std::abs(y) > 2) continue;
    const Eigen::Vector2d pixel = color_.distort({x, y});
    if (pixel.x() < 0 || pixel.y() < 0 || pixel.x() > color_.width - 1 || pixel.y() > color_.height - 1) continue;
    const double distance = from_camera.norm();
    if (-from_camera.dot(directions_[i]) < min_cosine * distance) continue;
    const float log_distance = std::log(static_cast<float>(distance));
    const int lowest = static_cast<int>(std::floor((log_min_reference_[i] - log_distance) / log_scale_)) - limits.level_margin;
    const int highest = static_cast<int>(std::ceil((log_max_reference_[i] - log_distance) / log_scale_)) + limits.level_margin;
    if (highest < 0 || lowest > num_levels_ - 1) continue;
    ProjectedLandmark& out = projected_.emplace_back();
    out.landmark = static_cast<std::int32_t>(i);
    out.u = static_cast<float>(pixel.x());
    out.v = static_cast<float>(pixel.y());
    out.radius_px = radius_px;
    out.min_level = static_cast<std::uint8_t>(std::clamp(lowest, 0, num_levels_ - 1));
    out.max_level = static_cast<std::uint8_t>(std::clamp(highest, 0, num_levels_ - 1));
    out.first_descriptor = first_descriptor_[i];
    out.num_descriptors = static_cast<std::uint32_t>(descriptors_of(i).size());
  }
  return projected_;
}

}  // namespace camloc
