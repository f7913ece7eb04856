// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/slam/keyframe_insertion.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/features/hamming.h"

namespace camloc {
namespace {

constexpr std::size_t kNumNeighbours = 5;
constexpr float kFuseRadiusPx = 4;
constexpr double kMaxDepthSigmas = 3;
constexpr int kMaxFuseDistance = 50;

// Far landmarks.
constexpr std::size_t kNumPartners = 4;        // keyframes compared with
constexpr std::uint32_t kMaxKeyframeGap = 30;  // only this far back in the recording
constexpr double kMinBaselineM = 0.25;         // between the two camera centres
constexpr int kMaxDistanceBits = 50;           // Hamming
constexpr double kMaxRatio = 0.85;             // of the two nearest distances
constexpr double kMaxErrorSigmas = 2.5;        // of the reprojection in both frames

/// Features that could become a far landmark.
struct OpenFeatures {
  std::vector<std::uint32_t> index;
  std::vector<Descriptor> descriptors;
};

OpenFeatures open_features(const SlamKeyframe& keyframe) {
  OpenFeatures open;
  for (std::uint32_t f = 0; f < keyframe.view.size(); ++f) {
    if (keyframe.landmark_of_feature[f] != kNoLandmark || keyframe.view.depth_m[f] > 0) continue;
    open.index.push_back(f);
    open.descriptors.push_back(keyframe.view.features.descriptors[f]);
  }
  return open;
}

/// Reprojection error in standard deviations; large behind the camera.
double error_sigmas(const SlamMap& map, const FrameFeatures& view, std::uint32_t feature, const Eigen::Vector3d& p_map) {
  const Eigen::Vector3d p_camera = view.T_map_camera.inverse() * p_map;
  if (p_camera.z() < 0.1) return 1e9;
  const Eigen::Vector2d error = p_camera.head<2>() / p_camera.z() - view.normalized[feature].cast<double>();
  return error.norm() * map.camera().color.mean_focal_px() / map.levels().sigma_px(view.features.keypoints[feature].level);
}

bool is_sound(const SlamNumbers& numbers, const SlamMap& map, const FrameFeatures& a, std::uint32_t feature_a, const FrameFeatures& b,
              std::uint32_t feature_b, const Eigen::Vector3d& p_map) {
  const Eigen::Vector3d to_a = a.T_map_camera.translation - p_map, to_b = b.T_map_camera.translation - p_map;
  const double distance = std::max(to_a.norm(), to_b.norm());
  if (!(distance < numbers.far_max_distance_m) ||
      to_a.cross(to_b).norm() < std::sin(numbers.far_min_parallax_rad) * to_a.norm() * to_b.norm())
    return false;
  // The same corner is seen at a size that fits the two distances.
  const double ratio = to_a.norm() * map.levels().scale(a.features.keypoints[feature_a].level) /
                       (to_b.norm() * map.levels().scale(b.features.keypoints[feature_b].level));
  if (ratio > 1.6 || ratio < 1 / 1.6) return false;
  return error_sigmas(map, a, feature_a, p_map) <= kMaxErrorSigmas && error_sigmas(map, b, feature_b, p_map) <= kMaxErrorSigmas;
}

std::vector<std::uint32_t> partners(std::uint32_t keyframe, const SlamMap& map) {
  std::vector<std::uint32_t> result;
  double next_baseline = kMinBaselineM;
  const Rigid3& T_map_here = map.T_map_camera(keyframe);
  const Eigen::Vector3d axis = T_map_here.rotation * Eigen::Vector3d::UnitZ();
  for (std::uint32_t back = 1; back <= std::min(kMaxKeyframeGap, keyframe); ++back) {
    const SlamKeyframe& other = map.keyframe(keyframe - back);
    if (other.segment != map.keyframe(keyframe).segment) break;
    const Rigid3& T_map_other = other.view.T_map_camera;
    const double baseline = (T_map_other.translation - T_map_here.translation).norm();
    if (baseline < next_baseline || axis.dot(T_map_other.rotation * Eigen::Vector3d::UnitZ()) < 0.9) continue;
    result.push_back(keyframe - back);
    if (result.size() == kNumPartners) break;
    next_baseline = 1.8 * baseline;  // near ones for what is near, far ones for what is far
  }
  return result;
}

int add_with_partner(const SlamNumbers& numbers, std::uint32_t keyframe, std::uint32_t partner, SlamMap* map) {
  const OpenFeatures here = open_features(map->keyframe(keyframe)), there = open_features(map->keyframe(partner));
  if (here.index.empty() || there.index.empty()) return 0;
  std::vector<NearestDescriptor> nearest(here.index.size()), back(there.index.size());
  nearest_descriptors(here.descriptors, there.descriptors, nearest.data());
  nearest_descriptors(there.descriptors, here.descriptors, back.data());
  int num_added = 0;
  for (std::uint32_t i = 0; i < here.index.size(); ++i) {
    const NearestDescriptor& n = nearest[i];
    if (n.distance > kMaxDistanceBits || n.distance > kMaxRatio * n.second || back[n.index].index != i) continue;
    const FrameFeatures& a = map->keyframe(keyframe).view;
    const FrameFeatures& b = map->keyframe(partner).view;
    const std::uint32_t feature_a = here.index[i], feature_b = there.index[n.index];
    const auto point =
        triangulate(a.T_map_camera, a.normalized[feature_a].cast<double>(), b.T_map_camera, b.normalized[feature_b].cast<double>());
    if (!point || !is_sound(numbers, *map, a, feature_a, b, feature_b, *point)) continue;
    map->add_landmark(*point, {partner, feature_b}, {keyframe, feature_a});
    ++num_added;
  }
  return num_added;
}

}  // namespace

std::uint32_t insert_keyframe(std::uint64_t frame, std::uint32_t segment, const FrameFeatures& view,
                              const std::vector<LandmarkObservation>& tracked, SlamMap* map) {
  const std::uint32_t keyframe = map->add_keyframe(frame, segment, view);
  for (const LandmarkObservation& pair : tracked) {
    const std::int32_t landmark = map->resolve(pair.landmark);
    if (landmark == kNoLandmark) continue;
    map->add_observation(static_cast<std::uint32_t>(landmark), {keyframe, pair.feature});
    map->summarize(static_cast<std::uint32_t>(landmark));
  }
  for (std::uint32_t feature = 0; feature < view.size(); ++feature) {
    if (map->keyframe(keyframe).landmark_of_feature[feature] == kNoLandmark && view.depth_m[feature] > 0)
      map->add_landmark({keyframe, feature});
  }
  return keyframe;
}

int fuse_into_keyframe(LandmarkSet* landmarks, std::uint32_t keyframe, float radius_px, PoseSolver* solver, SlamMap* map) {
  const FrameFeatures& view = map->keyframe(keyframe).view;
  const Rigid3 T_camera_map = view.T_map_camera.inverse();
  int num_fused = 0;
  solver->begin(view);
  for (const Match& match : solver->search_by_projection(landmarks, view.T_map_camera, radius_px)) {
    if (match.distance > kMaxFuseDistance) continue;
    const auto feature = static_cast<std::uint32_t>(match.feature);
    const std::int32_t into = map->resolve(landmarks->id(static_cast<std::size_t>(match.landmark)));
    if (into == kNoLandmark) continue;
    const double depth = view.depth_m[feature];
    const double z = (T_camera_map * map->landmark(static_cast<std::uint32_t>(into)).position_m).z();
    if (depth > 0 && std::abs(z - depth) > kMaxDepthSigmas * map->camera().depth_noise.sigma_m(depth) + 0.01) continue;
    const std::int32_t present = map->keyframe(keyframe).landmark_of_feature[feature];
    if (present == into) continue;
    if (present == kNoLandmark) {
      map->add_observation(static_cast<std::uint32_t>(into), {keyframe, feature});
      map->summarize(static_cast<std::uint32_t>(into));
    } else {
      map->merge(static_cast<std::uint32_t>(present), static_cast<std::uint32_t>(into));
    }
    ++num_fused;
  }
  return num_fused;
}

void fuse_with_neighbours(std::uint32_t keyframe, PoseSolver* solver, SlamMap* map) {
  LandmarkSet own = map->empty_landmark_set();
  map->collect_landmarks(std::array{keyframe}, map->keyframe(keyframe).view.size(), &own);
  const auto neighbours = map->covisible(keyframe, 20);
  for (std::size_t i = 0; i < std::min(kNumNeighbours, neighbours.size()); ++i)
    fuse_into_keyframe(&own, neighbours[i].keyframe, kFuseRadiusPx, solver, map);
}

std::optional<Eigen::Vector3d> triangulate(const Rigid3& T_map_a, const Eigen::Vector2d& ray_a, const Rigid3& T_map_b,
                                           const Eigen::Vector2d& ray_b) {
  const Eigen::Vector3d direction_a = (T_map_a.rotation * ray_a.homogeneous()).normalized();
  const Eigen::Vector3d direction_b = (T_map_b.rotation * ray_b.homogeneous()).normalized();
  const Eigen::Vector3d between = T_map_b.translation - T_map_a.translation;
  const double cosine = direction_a.dot(direction_b), determinant = 1 - cosine * cosine;
  if (determinant < 1e-8) return std::nullopt;
  const double along_a = between.dot(direction_a), along_b = between.dot(direction_b);
  const double distance_a = (along_a - cosine * along_b) / determinant, distance_b = (cosine * along_a - along_b) / determinant;
  if (distance_a <= 0 || distance_b <= 0) return std::nullopt;
  return 0.5 * (T_map_a.translation + distance_a * direction_a + T_map_b.translation + distance_b * direction_b);
}

int add_far_landmarks(const SlamNumbers& numbers, std::uint32_t keyframe, SlamMap* map) {
  int num_added = 0;
  for (const std::uint32_t partner : partners(keyframe, *map)) num_added += add_with_partner(numbers, keyframe, partner, map);
  return num_added;
}

}  // namespace camloc
