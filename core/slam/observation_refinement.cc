// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/slam/observation_refinement.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/dense/patch_alignment.h"

namespace camloc {
namespace {

constexpr double kMaxMagnification = 2.0;  // of area and its inverse, between two patches

/// An observation and what belongs to it.
struct Seen {
  const SlamKeyframe& keyframe;
  std::uint32_t feature;
  double scale;              ///< of its level
  Eigen::Vector3d p_camera;  ///< the landmark
};

Seen seen_by(const SlamMap& map, const Observation& observation, const Eigen::Vector3d& p_map) {
  const SlamKeyframe& keyframe = map.keyframe(observation.keyframe);
  const double scale = map.levels().scale(keyframe.view.features.keypoints[observation.feature].level);
  return {keyframe, observation.feature, scale, keyframe.view.T_map_camera.inverse() * p_map};
}

/// The observation from the middle of all directions and distances: the others are the least distorted beside it.
std::size_t choose_reference(const SlamMap& map, const SlamLandmark& landmark) {
  const double middle = 0.5 * (std::log(landmark.min_reference_m) + std::log(landmark.max_reference_m));
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < landmark.observations.size(); ++i) {
    const Observation& observation = landmark.observations[i];
    const SlamKeyframe& keyframe = map.keyframe(observation.keyframe);
    const Eigen::Vector3d to_camera = keyframe.view.T_map_camera.translation - landmark.position_m;
    const double distance = to_camera.norm();
    const double turned = std::acos(std::clamp(to_camera.dot(landmark.direction) / distance, -1.0, 1.0));
    const double scaled =
        std::abs(std::log(distance * map.levels().scale(keyframe.view.features.keypoints[observation.feature].level)) - middle);
    if (turned + scaled < least) {
      least = turned + scaled;
      best = i;
    }
  }
  return best;
}

/// How pixels around the target's observation lie around the reference's, taking the surface to face the reference. The focal
/// length cancels.
std::optional<Eigen::Matrix2d> warp(const Seen& reference, const Seen& target) {
  if (reference.p_camera.z() < 0.1 || target.p_camera.z() < 0.1) return std::nullopt;
  const Eigen::Matrix3d R_target_reference =
      (target.keyframe.view.T_map_camera.rotation.conjugate() * reference.keyframe.view.T_map_camera.rotation).toRotationMatrix();
  const Eigen::Vector2d at = target.p_camera.head<2>() / target.p_camera.z();
  const Eigen::Matrix2d turned = R_target_reference.topLeftCorner<2, 2>() - at * R_target_reference.bottomLeftCorner<1, 2>();
  const double magnification = reference.scale * reference.p_camera.z() / (target.scale * target.p_camera.z());
  const Eigen::Matrix2d A_target_reference = magnification * turned;
  const double area = A_target_reference.determinant();
  if (!(area > 1 / kMaxMagnification && area < kMaxMagnification)) return std::nullopt;
  return A_target_reference.inverse();
}

/// Where the target shows the reference's point, in pixels of level 0 from its own; nothing where it cannot be aligned.
std::optional<Eigen::Vector2f> shift_px_of(const Seen& reference, const Seen& target) {
  const std::optional<Eigen::Matrix2d> A_reference_target = warp(reference, target);
  if (!A_reference_target) return std::nullopt;
  const PatchAlignment aligned =
      align_patch(reference.keyframe.view.patches[reference.feature], *A_reference_target, target.keyframe.view.patches[target.feature]);
  if (aligned.verdict != PatchVerdict::kAligned) return std::nullopt;
  return (target.scale * aligned.shift_px).cast<float>();
}

}  // namespace

std::uint64_t refine_observations(SlamMap* map) {
  std::uint64_t num_aligned = 0;
  const UndistortionTable rays(map->camera().color);
  for (std::uint32_t index = 0; index < map->landmarks().size(); ++index) {
    const SlamLandmark& landmark = map->landmark(index);
    if (landmark.observations.size() < 2) continue;
    const std::size_t chosen = choose_reference(*map, landmark);
    const Seen reference = seen_by(*map, landmark.observations[chosen], landmark.position_m);
    if (reference.keyframe.view.patches.empty()) continue;
    for (std::size_t i = 0; i < landmark.observations.size(); ++i) {
      const Observation& observation = landmark.observations[i];
      const Seen target = seen_by(*map, observation, landmark.position_m);
      if (target.keyframe.view.patches.empty()) continue;
      const Keypoint& found = target.keyframe.view.features.keypoints[observation.feature];
      Eigen::Vector2f shift_px = Eigen::Vector2f::Zero();
      if (const auto shift = i == chosen ? std::nullopt : shift_px_of(reference, target)) {
        shift_px = *shift;
        ++num_aligned;
      }
      map->keyframe(observation.keyframe).view.normalized[observation.feature] =
          rays.undistort(found.u + shift_px.x(), found.v + shift_px.y());
    }
  }
  return num_aligned;
}

}  // namespace camloc
