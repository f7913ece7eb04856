// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/mapping/picture/map_scene.h"

#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "core/base/order_statistics.h"
#include "tools/common/map_points.h"
#include "tools/mapping/site/map_up.h"

namespace camloc::mapping {
namespace {

constexpr double kCutAboveCamerasM = 0.6;  // landmarks higher above the highest keyframe hide the floor plan

/// Along an axis: landmarks from the 1st to the 99th percentile, and everything that was walked.
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
  for (const auto* positions : {&scene.keyframes, &scene.walk}) {
    for (const Eigen::Vector3d& p : *positions) add(axis.dot(p));
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
  Scene scene{&picture, up_axis(map), {}, {}, {}, {}, 0, 0, false};
  double cut_m = -std::numeric_limits<double>::infinity();
  for (std::uint32_t k = 0; k < map.keyframes().size(); ++k) {
    scene.keyframes.push_back(map.keyframe_pose(k).translation);
    cut_m = std::max(cut_m, scene.up.dot(scene.keyframes.back()) + kCutAboveCamerasM);
  }
  for (const Rigid3& pose : picture.trajectory) scene.walk.push_back(pose.translation);
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
  Eigen::Index flattest = 0;
  scene.up.cwiseAbs().minCoeff(&flattest);
  const Eigen::Vector3d first = (Eigen::Vector3d::Unit(flattest) - scene.up * scene.up[flattest]).normalized(),
                        second = scene.up.cross(first);
  Eigen::Vector3d right = first;
  double best = 0;
  for (int degrees = 0; degrees < 90; ++degrees) {
    const double angle = degrees * std::numbers::pi / 180;
    const Eigen::Vector3d a = std::cos(angle) * first + std::sin(angle) * second;
    const double score = wall_score(scene, a) + wall_score(scene, scene.up.cross(a));
    if (score < 1.02 * best) continue;  // a turn must be worth it
    best = score;
    right = a;
  }
  if (extent_along(scene, right).length() < extent_along(scene, scene.up.cross(right)).length()) right = scene.up.cross(right);
  Eigen::Index main = 0;
  right.cwiseAbs().maxCoeff(&main);
  if (right[main] < 0) right = -right;
  const Eigen::Vector3d down = right.cross(scene.up);
  return {right, down, extent_along(scene, right), extent_along(scene, down)};
}

Viewpoint top_view(const Plan& plan, int width, int height, int margin_px) {
  Viewpoint view;
  Eigen::Matrix3d axes;
  axes << plan.right.transpose(), plan.down.transpose(), plan.right.cross(plan.down).transpose();
  view.T_view_world.rotation = Eigen::Quaterniond(axes).normalized();
  view.px_per_m = std::min(std::max(1, width - 2 * margin_px) / plan.u.length(), std::max(1, height - 2 * margin_px) / plan.v.length());
  view.center_u = 0.5 * (width - 1) - view.px_per_m * 0.5 * (plan.u.low + plan.u.high);
  view.center_v = 0.5 * (height - 1) - view.px_per_m * 0.5 * (plan.v.low + plan.v.high);
  return view;
}

}  // namespace camloc::mapping
