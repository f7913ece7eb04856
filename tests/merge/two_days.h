// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Maps of one generated corridor as two walks would have made them: each in a frame of its own, with its own noise, what was
// missed, what looks different, and its own drift.
#pragma once

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "core/map/map_data.h"
#include "core/mapmaking/vocabulary.h"
#include "tests/map/room_map.h"

namespace camloc::testing {

/// Points on the walls y = 2 and y = -2 of a corridor along x.
struct Corridor {
  struct Point {
    Eigen::Vector3d position_m, normal;
    Descriptor descriptor, changed;  ///< how it looks, and how it looks after it was changed
  };
  std::vector<Point> points;
};

/// `period_m` > 0: the corridor looks the same again after that length.
inline Corridor make_corridor(std::uint32_t seed, double length_m = 20, double period_m = 0) {
  Random random(seed);
  Corridor corridor;
  const double unique_m = period_m > 0 ? period_m : length_m;
  for (int i = 0; i < static_cast<int>(120 * unique_m); ++i) {
    const double side = i % 2 == 0 ? 2 : -2;
    const Corridor::Point point{
        {random.uniform(0, unique_m), side, random.uniform(0, 2.5)}, {0, side > 0 ? -1.0 : 1.0, 0}, random.descriptor(), {}};
    for (double offset = 0; offset < length_m; offset += unique_m) {
      corridor.points.push_back(point);
      corridor.points.back().position_m.x() += offset;
    }
  }
  for (Corridor::Point& point : corridor.points) point.changed = random.noisy(point.descriptor, 90);
  return corridor;
}

struct DayOptions {
  std::uint32_t seed = 1;
  Rigid3 T_day_world;
  double first_m = 0, last_m = 20;  ///< stretch that was walked
  double missed_share = 0.3;
  double changed_share = 0;  ///< of the points that look different
  int noise_bits = 12;
  double noise_m = 0.003;
  double curvature_per_m = 0;  ///< drift: the heading errs by this for each metre
  std::uint32_t num_observations = 6;
};

/// The corridor as drift bends it: heading grows with the way.
inline Rigid3 bent(const Rigid3& T_world_camera, double curvature_per_m) {
  const double x = T_world_camera.translation.x(), angle = curvature_per_m * x;
  Rigid3 T = T_world_camera;
  T.translation.y() += 0.5 * curvature_per_m * x * x;
  T.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ())) * T.rotation;
  return T;
}

inline MapData make_day(const Corridor& corridor, const DayOptions& options) {
  Random random(options.seed);
  MapData map;
  map.name = "day " + std::to_string(options.seed);
  map.camera = room_camera();
  std::vector<Eigen::Vector3d> truth;
  for (const Corridor::Point& point : corridor.points) {
    const bool is_missed = random.uniform(0, 1) < options.missed_share, is_changed = random.uniform(0, 1) < options.changed_share;
    if (is_missed || point.position_m.x() < options.first_m - 2 || point.position_m.x() > options.last_m + 2) continue;
    const Rigid3 T_bent = options.T_day_world * bent({Eigen::Quaterniond::Identity(), point.position_m}, options.curvature_per_m);
    MapLandmark landmark =
        room_landmark(T_bent.translation + options.noise_m * random.direction(), T_bent.rotation * point.normal, &random);
    landmark.min_reference_m = 1.5F;
    landmark.max_reference_m = 5.0F;
    landmark.position_sigma_m = 0.004F;
    landmark.num_observations = options.num_observations;
    landmark.descriptors = {random.noisy(is_changed ? point.changed : point.descriptor, options.noise_bits)};
    map.landmarks.push_back(landmark);
    truth.push_back(point.position_m);
  }
  int step = 0;
  for (double x = options.first_m; x <= options.last_m; x += 0.5, ++step) {
    const double yaw = (step % 2 == 0 ? 1.57 : -1.57) + random.uniform(-0.4, 0.4);
    const Rigid3 T_world_camera = looking({x, random.uniform(-0.5, 0.5), random.uniform(1.2, 1.6)}, {std::cos(yaw), std::sin(yaw), 0});
    MapKeyframe keyframe;
    keyframe.T_map_camera = options.T_day_world * bent(T_world_camera, options.curvature_per_m);
    for (std::uint32_t i = 0; i < truth.size(); ++i) {
      const Eigen::Vector3d p = T_world_camera.inverse() * truth[i];
      if (p.z() < 0.5 || p.z() > 5) continue;
      const Eigen::Vector2d pixel = map.camera.color.project(p);
      if (pixel.x() >= 5 && pixel.y() >= 5 && pixel.x() < 634 && pixel.y() < 474) keyframe.landmarks.push_back(i);
    }
    map.keyframes.push_back(std::move(keyframe));
  }
  // A map has no landmark that no keyframe sees.
  std::vector<std::uint32_t> new_index(map.landmarks.size(), 0);
  std::set<std::uint32_t> seen;
  for (const MapKeyframe& keyframe : map.keyframes) seen.insert(keyframe.landmarks.begin(), keyframe.landmarks.end());
  std::vector<MapLandmark> kept;
  for (const std::uint32_t i : seen) {
    new_index[i] = static_cast<std::uint32_t>(kept.size());
    kept.push_back(map.landmarks[i]);
  }
  map.landmarks = std::move(kept);
  for (MapKeyframe& keyframe : map.keyframes) {
    for (std::uint32_t& i : keyframe.landmarks) i = new_index[i];
  }
  std::vector<Descriptor> descriptors;
  for (const MapLandmark& landmark : map.landmarks) descriptors.push_back(landmark.descriptors[0]);
  map.words = train_vocabulary(descriptors, 64);
  build_inverted_file(&map);
  return map;
}

}  // namespace camloc::testing
