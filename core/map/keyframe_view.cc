// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/map/keyframe_view.h"

#include <algorithm>
#include <cmath>

namespace camloc {

KeyframeView view_of_keyframe(const MapData& map, std::uint32_t keyframe) {
  const RgbdCamera& camera = map.camera;
  KeyframeView result;
  result.view.T_map_camera = map.keyframes[keyframe].T_map_camera;
  const Rigid3 T_camera_map = result.view.T_map_camera.inverse();
  const float log_scale = std::log(map.orb_scale_factor);
  for (const std::uint32_t index : map.keyframes[keyframe].landmarks) {
    const MapLandmark& landmark = map.landmarks[index];
    const Eigen::Vector3d p_camera = T_camera_map * landmark.position_m.cast<double>();
    if (!(p_camera.z() > 0.1)) continue;
    const Eigen::Vector2d pixel = camera.color.project(p_camera);
    if (!(pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() <= camera.color.width - 1 && pixel.y() <= camera.color.height - 1)) continue;
    const float reference_m = std::sqrt(landmark.min_reference_m * landmark.max_reference_m);
    const float level = std::round(std::log(reference_m / static_cast<float>(p_camera.norm())) / log_scale);
    Keypoint keypoint;
    keypoint.u = static_cast<float>(pixel.x());
    keypoint.v = static_cast<float>(pixel.y());
    keypoint.angle_rad = landmark.angle_rad;
    keypoint.level = static_cast<std::uint8_t>(std::clamp(level, 0.0F, static_cast<float>(map.orb_num_levels) - 1));
    const bool has_depth = p_camera.z() >= camera.min_depth_m && p_camera.z() <= camera.max_depth_m;
    result.view.features.keypoints.push_back(keypoint);
    result.view.features.descriptors.push_back(landmark.descriptors.front());
    result.view.normalized.push_back((p_camera.head<2>() / p_camera.z()).cast<float>());
    result.view.depth_m.push_back(has_depth ? static_cast<float>(p_camera.z()) : 0.0F);
    result.landmarks.push_back(index);
  }
  return result;
}

}  // namespace camloc
