// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A view meets the landmarks so far: those near its own 3D points are projected into it and paired with the features around
// (gather_candidates, find_pairs), the closest descriptors first get each other, and what is left with depth starts landmarks
// of its own. Each observation moves its landmark's position and may add an appearance. What is said about a landmark once
// all views are in is in landmark_summary.cc.
#include "core/mapmaking/landmark_fusion.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "core/base/mix_bits.h"
#include "core/features/hamming.h"

namespace camloc {
namespace {

// Wide enough that the neighbouring voxels of a point hold every landmark it may be fused with up to about 5 m.
constexpr double kVoxelM = 0.30;
// Recorded poses shake by a few millimetres from frame to frame; no observation is better than that.
constexpr double kPoseNoiseM = 0.004;
constexpr std::int64_t kNone = -1, kAbsorbed = -2;
// What makes a feature another observation of a landmark.
constexpr float kRadiusPx = 2.5F;      // of level 0, from where the landmark is projected; grows with the feature's level
constexpr int kMaxDistance = 64;       // of the descriptor to any appearance of the landmark
constexpr double kMaxDepthSigmas = 3;  // along the optical axis, within these two bounds
constexpr double kMinDepthToleranceM = 0.02, kMaxDepthToleranceM = 0.30;
constexpr float kMaxReferenceRatio = 2;  // of the reference distance to the range the landmark has been seen with

std::uint64_t voxel_key(std::int64_t x, std::int64_t y, std::int64_t z) {
  constexpr std::int64_t kOffset = 1 << 20;
  constexpr std::uint64_t kMask = (1U << 21) - 1;
  return ((static_cast<std::uint64_t>(x + kOffset) & kMask) << 42) | ((static_cast<std::uint64_t>(y + kOffset) & kMask) << 21) |
         (static_cast<std::uint64_t>(z + kOffset) & kMask);
}

std::array<std::int64_t, 3> voxel_of(const Eigen::Vector3d& p) {
  return {static_cast<std::int64_t>(std::floor(p.x() / kVoxelM)), static_cast<std::int64_t>(std::floor(p.y() / kVoxelM)),
          static_cast<std::int64_t>(std::floor(p.z() / kVoxelM))};
}

int distance_to_any(const std::vector<Descriptor>& appearances, const Descriptor& descriptor) {
  int best = 257;
  for (const Descriptor& a : appearances) best = std::min(best, hamming_distance(a, descriptor));
  return best;
}

}  // namespace

LandmarkFusion::LandmarkFusion(const Intrinsics& color, const DepthNoise& depth_noise, const OrbOptions& orb)
    : color_(color),
      depth_noise_(depth_noise),
      max_features_(static_cast<std::size_t>(orb.num_features)),
      grid_(color.width, color.height, orb.num_features) {
  for (int level = 0; level < 256; ++level) {
    scale_.push_back(std::pow(orb.scale_factor, static_cast<float>(std::min(level, orb.num_levels - 1))));
  }
}

void LandmarkFusion::add_view(const FrameFeatures& view) {
  const std::size_t size = std::min(view.features.size(), max_features_);
  views_.emplace_back();
  poses_.push_back(view.T_map_camera);
  landmark_of_feature_.assign(size, kNone);
  is_new_.assign(size, 0);
  grid_.assign(std::span(view.features.keypoints).first(size));
  gather_candidates(view);
  find_pairs(view);

  std::vector<std::uint8_t> is_landmark_taken(landmarks_.size(), 0);
  for (const Pair& pair : pairs_) {
    auto& owner = landmark_of_feature_[static_cast<std::size_t>(pair.feature)];
    if (owner >= 0) continue;
    if (is_landmark_taken[pair.landmark] != 0) {
      owner = kAbsorbed;  // may still get a landmark of its own further down the list
      continue;
    }
    is_landmark_taken[pair.landmark] = 1;
    owner = pair.landmark;
  }
  for (const Pair& pair : pairs_) {
    if (landmark_of_feature_[static_cast<std::size_t>(pair.feature)] == kAbsorbed) {
      widen_scale(view, static_cast<std::size_t>(pair.feature), &landmarks_[pair.landmark]);
    }
  }
  for (std::size_t i = 0; i < size; ++i) {
    std::int64_t& owner = landmark_of_feature_[i];
    if (owner >= 0) {
      observe(view, i, static_cast<std::uint32_t>(owner));
    } else if (owner == kAbsorbed || view.depth_m[i] <= 0) {
      continue;
    } else if (const std::int64_t repeated = find_new_landmark(view, i); repeated >= 0) {
      widen_scale(view, i, &landmarks_[static_cast<std::size_t>(repeated)]);
    } else {
      owner = create(view, i);
      is_new_[i] = 1;
    }
  }
}

// Landmarks in the voxels around the view's own 3D points: what lies elsewhere is out of sight or at another depth.
void LandmarkFusion::gather_candidates(const FrameFeatures& view) {
  std::vector<std::array<std::int64_t, 3>> occupied;
  for (std::size_t i = 0; i < landmark_of_feature_.size(); ++i) {
    if (view.depth_m[i] > 0) occupied.push_back(voxel_of(view.T_map_camera * view.point_camera(i)));
  }
  std::sort(occupied.begin(), occupied.end());
  occupied.erase(std::unique(occupied.begin(), occupied.end()), occupied.end());
  std::vector<std::uint64_t> keys;
  keys.reserve(occupied.size() * 27);
  for (const auto& v : occupied) {
    for (int offset = 0; offset < 27; ++offset)
      keys.push_back(voxel_key(v[0] + offset % 3 - 1, v[1] + offset / 3 % 3 - 1, v[2] + offset / 9 - 1));
  }
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  candidates_.clear();
  for (const std::uint64_t key : keys) {
    const auto found = voxels_.find(key);
    if (found != voxels_.end()) candidates_.insert(candidates_.end(), found->second.begin(), found->second.end());
  }
}

// All admissible pairs of a candidate and a feature, best descriptor first.
void LandmarkFusion::find_pairs(const FrameFeatures& view) {
  pairs_.clear();
  const Rigid3 T_camera_map = view.T_map_camera.inverse();
  const Eigen::Matrix3d R = T_camera_map.rotation.toRotationMatrix();  // a third of the work of a quaternion, a million times
  for (const std::uint32_t index : candidates_) {
    const Eigen::Vector3d p_camera = R * landmarks_[index].position_m + T_camera_map.translation;
    if (p_camera.z() > 0.1) pair_landmark(view, index, p_camera);
  }
  std::sort(pairs_.begin(), pairs_.end(), [](const Pair& a, const Pair& b) {
    return std::tie(a.distance, a.landmark, a.feature) < std::tie(b.distance, b.landmark, b.feature);
  });
}

void LandmarkFusion::pair_landmark(const FrameFeatures& view, std::uint32_t index, const Eigen::Vector3d& p_camera) {
  const Fused& landmark = landmarks_[index];
  const Eigen::Vector2f pixel = color_.project(p_camera).cast<float>();
  const float reach = kRadiusPx * scale_[255];
  const auto width = static_cast<float>(color_.width), height = static_cast<float>(color_.height);
  // Written so that a NaN fails, too.
  if (!(pixel.x() >= -reach && pixel.y() >= -reach && pixel.x() < width + reach && pixel.y() < height + reach)) return;
  const auto bucket_of = [&](float value, int count) {
    return std::clamp(static_cast<int>(std::floor(value / static_cast<float>(grid_.cell_px()))), 0, count - 1);
  };
  const int first_column = bucket_of(pixel.x() - reach, grid_.columns()), last_column = bucket_of(pixel.x() + reach, grid_.columns());
  const int first_row = bucket_of(pixel.y() - reach, grid_.rows()), last_row = bucket_of(pixel.y() + reach, grid_.rows());
  for (int row = first_row; row <= last_row; ++row) {
    for (int column = first_column; column <= last_column; ++column) {
      for (const std::int32_t feature : grid_.bucket(column, row)) {
        const auto f = static_cast<std::size_t>(feature);
        const Keypoint& keypoint = view.features.keypoints[f];
        const float du = keypoint.u - pixel.x(), dv = keypoint.v - pixel.y(), limit = kRadiusPx * scale_[keypoint.level];
        if (du * du + dv * dv > limit * limit || !is_consistent(landmark, p_camera.z(), view, f)) continue;
        const int distance = distance_to_any(landmark.appearances, view.features.descriptors[f]);
        if (distance <= kMaxDistance) pairs_.push_back({distance, index, feature});
      }
    }
  }
}

bool LandmarkFusion::is_consistent(const Fused& landmark, double z_m, const FrameFeatures& view, std::size_t feature) const {
  const double depth = view.depth_m[feature];
  if (depth <= 0) return false;
  const double sigma = depth_noise_.sigma_m(depth) * std::sqrt(1.0 + 1.0 / landmark.num_observations);
  const double tolerance = std::clamp(kMaxDepthSigmas * sigma, kMinDepthToleranceM, kMaxDepthToleranceM);
  if (std::abs(z_m - depth) > tolerance) return false;
  const float reference = reference_m(view, feature);
  return reference * kMaxReferenceRatio >= landmark.min_reference_m && reference <= landmark.max_reference_m * kMaxReferenceRatio;
}

// The landmark that this view has just started at the same corner on another pyramid level, or kNone.
std::int64_t LandmarkFusion::find_new_landmark(const FrameFeatures& view, std::size_t feature) const {
  const Keypoint& keypoint = view.features.keypoints[feature];
  const float radius = kRadiusPx * scale_[keypoint.level];
  const auto bucket_of = [&](float value, int count) {
    return std::clamp(static_cast<int>(std::floor(value / static_cast<float>(grid_.cell_px()))), 0, count - 1);
  };
  for (int row = bucket_of(keypoint.v - radius, grid_.rows()); row <= bucket_of(keypoint.v + radius, grid_.rows()); ++row) {
    for (int column = bucket_of(keypoint.u - radius, grid_.columns()); column <= bucket_of(keypoint.u + radius, grid_.columns());
         ++column) {
      for (const std::int32_t other : grid_.bucket(column, row)) {
        const auto o = static_cast<std::size_t>(other);
        if (is_new_[o] == 0) continue;
        const Keypoint& rival = view.features.keypoints[o];
        if (std::hypot(rival.u - keypoint.u, rival.v - keypoint.v) > radius) continue;
        if (std::abs(view.depth_m[o] - view.depth_m[feature]) > kMinDepthToleranceM) continue;
        if (hamming_distance(view.features.descriptors[o], view.features.descriptors[feature]) <= kMaxDistance)
          return landmark_of_feature_[o];
      }
    }
  }
  return kNone;
}

float LandmarkFusion::reference_m(const FrameFeatures& view, std::size_t feature) const {
  const float distance = view.depth_m[feature] * std::sqrt(1.0F + view.normalized[feature].squaredNorm());
  return distance * scale_[view.features.keypoints[feature].level];
}

void LandmarkFusion::widen_scale(const FrameFeatures& view, std::size_t feature, Fused* landmark) const {
  const float reference = reference_m(view, feature);
  landmark->min_reference_m = std::min(landmark->min_reference_m, reference);
  landmark->max_reference_m = std::max(landmark->max_reference_m, reference);
}

std::uint8_t LandmarkFusion::cell_of(const Keypoint& keypoint) const {
  const int column = std::clamp(static_cast<int>(keypoint.u) * kCellColumns / color_.width, 0, kCellColumns - 1);
  const int row = std::clamp(static_cast<int>(keypoint.v) * kCellRows / color_.height, 0, kCellRows - 1);
  return static_cast<std::uint8_t>(row * kCellColumns + column);
}

std::uint32_t LandmarkFusion::create(const FrameFeatures& view, std::size_t feature) {
  const auto index = static_cast<std::uint32_t>(landmarks_.size());
  Fused& landmark = landmarks_.emplace_back();
  landmark.origin_m = landmark.position_m = view.T_map_camera * view.point_camera(feature);
  landmark.min_reference_m = landmark.max_reference_m = reference_m(view, feature);
  const auto v = voxel_of(landmark.origin_m);
  voxels_[voxel_key(v[0], v[1], v[2])].push_back(index);
  observe(view, feature, index);
  return index;
}

// Inverse-covariance weighted mean. The covariance is that of a pixel and a depth: p = z (x, y, 1).
void LandmarkFusion::observe(const FrameFeatures& view, std::size_t feature, std::uint32_t index) {
  Fused& landmark = landmarks_[index];
  const Keypoint& keypoint = view.features.keypoints[feature];
  const Eigen::Vector3d p_camera = view.point_camera(feature), p_map = view.T_map_camera * p_camera;
  const double z = p_camera.z(), lateral = z * scale_[keypoint.level] / color_.mean_focal_px(), sigma_z = depth_noise_.sigma_m(z);
  const Eigen::Vector3d ray = p_camera / z;
  Eigen::Matrix3d covariance = sigma_z * sigma_z * ray * ray.transpose();
  covariance.diagonal() += Eigen::Vector3d(lateral * lateral, lateral * lateral, 0);
  covariance.diagonal().array() += kPoseNoiseM * kPoseNoiseM;
  const Eigen::Matrix3d R = view.T_map_camera.rotation.toRotationMatrix();
  const Eigen::Matrix3d information = R * covariance.inverse() * R.transpose();
  const Eigen::Vector3d relative = p_map - landmark.origin_m;
  landmark.information += information;
  landmark.information_vector += information * relative;
  landmark.position_m = landmark.origin_m + landmark.information.inverse() * landmark.information_vector;
  landmark.sum += relative;
  landmark.sum_squared += relative.squaredNorm();
  ++landmark.num_observations;
  ++num_observations_;
  widen_scale(view, feature, &landmark);
  add_appearance(keypoint, view.features.descriptors[feature], index);
  views_.back().push_back({index, cell_of(keypoint)});
}

void LandmarkFusion::add_appearance(const Keypoint& keypoint, const Descriptor& descriptor, std::uint32_t index) {
  Fused& landmark = landmarks_[index];
  if (landmark.appearances.size() < kMaxDescriptors && distance_to_any(landmark.appearances, descriptor) > kAppearanceDistance) {
    landmark.appearances.push_back(descriptor);
  }
  // Reservoir sampling (Vitter, "Random sampling with a reservoir", 1985) with a hash for the dice.
  if (landmark.samples.size() < kMaxSamples) {
    landmark.samples.push_back({descriptor, keypoint.angle_rad});
    return;
  }
  const std::uint64_t slot = mix_bits((static_cast<std::uint64_t>(index) << 32) | landmark.num_observations) % landmark.num_observations;
  if (slot < kMaxSamples) landmark.samples[slot] = {descriptor, keypoint.angle_rad};
}

}  // namespace camloc
