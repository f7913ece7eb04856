// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "core/base/order_statistics.h"
#include "tools/common/map_points.h"
#include "tools/mapping/picture/map_picture.h"
#include "tools/mapping/site/map_up.h"

namespace camloc::mapping {
namespace {

constexpr double kCutAboveCamerasM = 0.6;  // landmarks higher above the highest keyframe hide the floor plan

/// Along an axis: landmarks from the 1st to the 99th percentile, and every camera.
Extent extent_along(const Scene& scene, const Eigen::Vector3d& axis) {
  Extent extent{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  const auto add = [&extent](double value) {
    extent.low = std::min(extent.low, value);
    extent.high = std::max(extent.high, value);
  };
  std::vector<double> values;
  for (const Eigen::Vector3d& p : scene.landmarks) values.push_back(axis.dot(p));
  if (!values.empty()) {
    add(lower_quantile(values, 0.01));
    add(lower_quantile(std::move(values), 0.99));
  }
  for (const auto* poses : {&scene.keyframes, &scene.picture->trajectory}) {
    for (const Rigid3& pose : *poses) add(axis.dot(pose.translation));
  }
  return extent;
}

/// How much the landmarks gather in planes across an axis: walls do when the axis is right.
double wall_score(const Scene& scene, const Eigen::Vector3d& axis) {
  constexpr double kBinM = 0.1;
  constexpr std::size_t kMaxSamples = 20000;
  std::map<long, double> bins;
  const std::size_t step = scene.landmarks.size() / kMaxSamples + 1;
  for (std::size_t i = 0; i < scene.landmarks.size(); i += step)
    ++bins[std::lround(std::clamp(axis.dot(scene.landmarks[i]) / kBinM, -1e9, 1e9))];
  double score = 0;
  for (const auto& [bin, count] : bins) score += count * count;
  return score;
}

}  // namespace

std::span<const Rgb> paper_ramp() { return value_ramp().subspan(45, 170); }

Scene make_scene(const MapPicture& picture) {
  const MapView& map = *picture.map;
  Scene scene{&picture, up_axis(map), tools::keyframe_poses(map), {}, {}};
  double cut_m = -std::numeric_limits<double>::infinity();
  for (const Rigid3& pose : scene.keyframes) cut_m = std::max(cut_m, scene.up.dot(pose.translation) + kCutAboveCamerasM);
  std::vector<double> heights;
  for (const Eigen::Vector3d& p : tools::landmark_positions(map)) {
    const double height = scene.up.dot(p);
    scene.is_cut = scene.is_cut || height > cut_m;
    if (height > cut_m) continue;
    scene.landmarks.push_back(p);
    heights.push_back(height);
  }
  scene.low_m = lower_quantile(heights, 0.02);
  scene.high_m = lower_quantile(heights, 0.98);
  const std::span<const Rgb> ramp = paper_ramp();
  for (const double height : heights) {
    const double fraction = scene.high_m > scene.low_m ? std::clamp((height - scene.low_m) / (scene.high_m - scene.low_m), 0.0, 1.0) : 0.5;
    scene.colors.push_back(ramp[static_cast<std::size_t>(fraction * static_cast<double>(ramp.size() - 1))]);
  }
  return scene;
}

Plan make_plan(const Scene& scene) {
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  double best = 0;
  for (const Eigen::Vector3d& a : level_directions(scene.up)) {
    const double score = wall_score(scene, a) + wall_score(scene, scene.up.cross(a));
    if (score < 1.02 * best) continue;  // a turn must be worth it
    best = score;
    right = a;
  }
  if (extent_along(scene, right).length() < extent_along(scene, scene.up.cross(right)).length()) right = scene.up.cross(right);
  right = turned_positive(right);
  const Eigen::Vector3d down = right.cross(scene.up);
  return {right, down, extent_along(scene, right), extent_along(scene, down)};
}

Viewpoint top_view(const Plan& plan, int width, int height, int margin_px) {
  Eigen::Matrix3d axes;
  axes << plan.right.transpose(), plan.down.transpose(), plan.right.cross(plan.down).transpose();
  return parallel_view(axes, plan.u, plan.v, width, height, margin_px);
}

}  // namespace camloc::mapping
