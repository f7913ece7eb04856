// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Generated truth for the bundle adjustment: rooms and corridors of landmarks, cameras in them, and what they would measure.
#pragma once

#include <algorithm>
#include <numbers>
#include <random>

#include "core/optimize/bundle_adjustment.h"
#include "tests/geometry/generated.h"

namespace camloc::testing {

struct BundleWorld {
  BundleOptions options;
  BundleProblem truth, start;            ///< `start` is disturbed; observations and fixed cameras are the same
  std::vector<std::uint8_t> is_outlier;  ///< per observation
};

struct BundleWorldOptions {
  std::uint32_t num_cameras = 20, num_landmarks = 600;
  std::uint32_t num_fixed = 1;  ///< the first ones, at the truth
  double noise_px = 1, outlier_ratio = 0, depth_ratio = 1;
  double position_error_m = 0.05, rotation_error_rad = 0.02, landmark_error_m = 0.05;
  double seen_ratio = 1;  ///< of the landmarks in view
  double corridor_m = 0;  ///< > 0: length of the way around a square of corridors instead of a room
};

/// Pose `s` metres along a square loop of this length, looking ahead.
inline Rigid3 pose_on_loop(double s, double length_m) {
  const double side = length_m / 4;
  const int edge = static_cast<int>(s / side) % 4;
  const double along = s - side * std::floor(s / side), yaw = 0.5 * std::numbers::pi * edge;
  const Eigen::Vector3d corners[] = {{0, 0, 0}, {side, 0, 0}, {side, side, 0}, {0, side, 0}};
  const Eigen::Vector3d forward(std::cos(yaw), std::sin(yaw), 0), down(0, 0, -1);
  Eigen::Matrix3d R;
  R << down.cross(forward), down, forward;
  return {Eigen::Quaterniond(R), corners[edge] + along * forward + Eigen::Vector3d(0, 0, 1.5)};
}

inline std::vector<Rigid3> make_cameras(std::mt19937& rng, const BundleWorldOptions& o) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<Rigid3> cameras;
  for (std::uint32_t i = 0; i < o.num_cameras; ++i) {
    if (o.corridor_m > 0) {
      cameras.push_back(disturbed(rng, pose_on_loop(o.corridor_m * i / o.num_cameras, o.corridor_m), 0.05, 0.05));
      continue;
    }
    const double yaw = 2 * std::numbers::pi * i / o.num_cameras;
    const Eigen::Vector3d forward = Eigen::Vector3d(std::cos(yaw), std::sin(yaw), 0.2 * uniform(rng)).normalized();
    const Eigen::Vector3d right = Eigen::Vector3d(0, 0, -1).cross(forward).normalized();
    Eigen::Matrix3d R;
    R << right, forward.cross(right), forward;
    const double x = uniform(rng), y = uniform(rng), z = 1.5 + 0.3 * uniform(rng);
    cameras.push_back({Eigen::Quaterniond(R), {x, y, z}});
  }
  return cameras;
}

/// On the walls of a room of 6 x 6 x 3 m, or of a corridor 2 m wide.
inline Eigen::Vector3d make_landmark(std::mt19937& rng, const BundleWorldOptions& o, std::uint32_t index) {
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const double side = uniform(rng) < 0.5 ? -1 : 1, along = uniform(rng), height = 3 * uniform(rng), relief = uniform(rng);
  if (o.corridor_m > 0) {  // numbered along the way, as they are created
    return pose_on_loop((index + along) / o.num_landmarks * o.corridor_m, o.corridor_m) *
           Eigen::Vector3d(side * (0.9 + 0.2 * relief), 1.5 - height, 0);
  }
  const double across = 6 * along - 3, depth = side * (3 - 0.5 * relief);
  return uniform(rng) < 0.5 ? Eigen::Vector3d(across, depth, height) : Eigen::Vector3d(depth, across, height);
}

inline bool is_in_view(const Eigen::Vector3d& p_camera) {
  return p_camera.z() > 0.5 && p_camera.z() < 6 && std::abs(p_camera.x()) < 0.61 * p_camera.z() &&
         std::abs(p_camera.y()) < 0.46 * p_camera.z();
}

inline BundleWorld make_bundle_world(std::mt19937& rng, const BundleWorldOptions& o) {
  BundleWorld world;
  BundleProblem& truth = world.truth;
  truth.T_map_camera = make_cameras(rng, o);
  truth.is_camera_fixed.assign(o.num_cameras, 0);
  std::fill_n(truth.is_camera_fixed.begin(), o.num_fixed, std::uint8_t{1});
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::normal_distribution<double> normal;
  const double focal_px = world.options.focal_px;
  for (std::uint32_t l = 0; l < o.num_landmarks; ++l) {
    const Eigen::Vector3d X = make_landmark(rng, o, l);
    truth.landmarks_m.push_back(X);
    for (std::uint32_t c = 0; c < o.num_cameras; ++c) {
      const Rigid3& T_map_camera = truth.T_map_camera[c];
      if ((X - T_map_camera.translation).squaredNorm() > 64) continue;
      const Eigen::Vector3d p = T_map_camera.rotation.conjugate() * (X - T_map_camera.translation);
      if (!is_in_view(p) || uniform(rng) > o.seen_ratio) continue;
      const bool is_outlier = uniform(rng) < o.outlier_ratio, has_depth = uniform(rng) < o.depth_ratio;
      const double spread = (is_outlier ? 60 : o.noise_px) / focal_px, stretch = is_outlier ? 0.5 + uniform(rng) : 1.0;
      const double x = p.x() / p.z() + spread * normal(rng), y = p.y() / p.z() + spread * normal(rng);
      const double depth = p.z() * stretch + world.options.depth_noise.sigma_m(p.z()) * normal(rng);
      truth.observations.push_back({c, l, static_cast<float>(x), static_cast<float>(y), has_depth ? static_cast<float>(depth) : 0.0F,
                                    static_cast<float>(std::max(o.noise_px, 0.1))});
      world.is_outlier.push_back(is_outlier ? 1 : 0);
    }
  }
  world.start = truth;
  for (std::uint32_t c = o.num_fixed; c < o.num_cameras; ++c) {
    world.start.T_map_camera[c] = disturbed(rng, truth.T_map_camera[c], o.position_error_m, o.rotation_error_rad);
  }
  for (Eigen::Vector3d& X : world.start.landmarks_m) X += random_vector(rng, o.landmark_error_m);
  return world;
}

/// Root mean square of the camera positions' errors, metres.
inline double camera_error_m(const BundleProblem& estimate, const BundleProblem& truth) {
  double sum = 0;
  for (std::size_t i = 0; i < truth.T_map_camera.size(); ++i) {
    sum += (estimate.T_map_camera[i].translation - truth.T_map_camera[i].translation).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(truth.T_map_camera.size()));
}

}  // namespace camloc::testing
