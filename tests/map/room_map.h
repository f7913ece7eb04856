// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A map of a small room made of numbers: landmarks on three walls, keyframes in the middle that look at them. Up is z.
#pragma once

#include "core/map/map_writer.h"
#include "core/mapmaking/vocabulary.h"
#include "tests/map/synthetic_map.h"

namespace camloc::testing {

/// Camera at `position` that looks along `forward`, image top upwards (z).
inline Rigid3 looking(const Eigen::Vector3d& position, const Eigen::Vector3d& forward) {
  const Eigen::Vector3d z = forward.normalized(), x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
  Eigen::Matrix3d R;
  R << x, z.cross(x), z;
  return {Eigen::Quaterniond(R), position};
}

inline MapLandmark room_landmark(const Eigen::Vector3d& position, const Eigen::Vector3d& towards_camera, Random* random) {
  MapLandmark landmark;
  landmark.position_m = position.cast<float>();
  landmark.direction = towards_camera.normalized().cast<float>();
  landmark.view_cosine = 0.5F;
  landmark.min_reference_m = static_cast<float>(towards_camera.norm());
  landmark.max_reference_m = 1.5F * landmark.min_reference_m;
  landmark.position_sigma_m = 0.01F;
  landmark.num_observations = 2 + random->below(100);
  landmark.descriptors = {random->descriptor()};
  return landmark;
}

/// Landmarks that a camera sees, ascending.
inline std::vector<std::uint32_t> landmarks_in_view(const MapData& map, const Rigid3& T_map_camera) {
  std::vector<std::uint32_t> seen;
  for (std::uint32_t i = 0; i < map.landmarks.size(); ++i) {
    const Eigen::Vector3d p = T_map_camera.inverse() * map.landmarks[i].position_m.cast<double>();
    if (p.z() < 0.3) continue;
    const Eigen::Vector2d pixel = map.camera.color.project(p);
    if (pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() < map.camera.color.width && pixel.y() < map.camera.color.height) seen.push_back(i);
  }
  return seen;
}

inline RgbdCamera room_camera() {
  RgbdCamera camera;
  camera.name = "room";
  camera.color = {640, 480, 520, 521, 319.5, 240.25, LensModel::kPinhole, {}};
  camera.depth = camera.color;
  return camera;
}

struct RoomOptions {
  int landmarks_per_wall = 120;
  int num_keyframes = 9;
  bool has_wcs = false;
};

/// 6 x 4 x 2.5 m; walls x = 3, y = -2, y = 2.
inline MapData make_room_map(const RoomOptions& options = {}) {
  Random random(7);
  MapData map;
  map.name = "room";
  map.camera = room_camera();
  for (int i = 0; i < options.landmarks_per_wall; ++i) {
    const double z = random.uniform(0, 2.5);
    const Eigen::Vector3d walls[] = {{3, random.uniform(-2, 2), z}, {random.uniform(-3, 3), -2, z}, {random.uniform(-3, 3), 2, z}};
    for (const Eigen::Vector3d& p : walls) map.landmarks.push_back(room_landmark(p, Eigen::Vector3d(0, 0, 1.25) - p, &random));
  }
  for (int k = 0; k < options.num_keyframes; ++k) {
    const double angle = -1.6 + 3.2 * k / std::max(1, options.num_keyframes - 1);
    MapKeyframe keyframe;
    keyframe.T_map_camera = looking({-1 + 0.2 * k, 0, 1.5}, {std::cos(angle), std::sin(angle), -0.1});
    keyframe.landmarks = landmarks_in_view(map, keyframe.T_map_camera);
    map.keyframes.push_back(std::move(keyframe));
  }
  std::vector<Descriptor> descriptors;
  for (const MapLandmark& landmark : map.landmarks) descriptors.push_back(landmark.descriptors[0]);
  map.words = train_vocabulary(descriptors, 32);
  build_inverted_file(&map);
  if (options.has_wcs) {
    map.wcs.emplace();
    map.wcs->T_wcs_map = {Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ())), {3500123.25, 5400456.5, 120.125}};
  }
  return map;
}

}  // namespace camloc::testing
