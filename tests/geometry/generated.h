// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Generated truth for the geometry tests: random poses and 2D-3D pairs with known noise and outliers.
#pragma once

#include <random>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/correspondences.h"
#include "core/geometry/rigid3.h"

namespace camloc::testing {

inline Eigen::Vector3d random_vector(std::mt19937& rng, double sigma) {
  std::normal_distribution<double> normal(0.0, sigma);
  const double x = normal(rng), y = normal(rng), z = normal(rng);
  return {x, y, z};
}

inline Rigid3 random_pose(std::mt19937& rng, double position_sigma_m) {
  std::normal_distribution<double> normal;
  const double w = normal(rng), x = normal(rng), y = normal(rng), z = normal(rng);
  return {Eigen::Quaterniond(w, x, y, z).normalized(), random_vector(rng, position_sigma_m)};
}

struct SceneOptions {
  int num_pairs = 200;
  double outlier_ratio = 0.0;
  double noise_px = 1.0;
  double focal_px = 525.0;          // true focal length
  double assumed_focal_px = 525.0;  // what turned pixels into normalized coordinates
  bool has_depth = true;
  bool is_rank_informative = false;  // outliers rank worse than inliers, with much overlap
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  DepthNoise depth_noise;
};

struct Scene {
  Correspondences pairs;
  Rigid3 T_map_camera;
  std::vector<std::uint8_t> is_inlier;  // before sorting by rank: index of `landmark`
};

/// Points 0.7 to 4.5 m in front of a 640x480 camera. Depth is noisy by the model; outliers are other points' positions.
inline Scene make_scene(std::mt19937& rng, const SceneOptions& options) {
  Scene scene{Correspondences(static_cast<std::size_t>(options.num_pairs)), random_pose(rng, 2.0), {}};
  scene.T_map_camera.translation += options.centre;
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::normal_distribution<double> normal;
  for (int i = 0; i < options.num_pairs; ++i) {
    const double z = 0.7 + 3.8 * uniform(rng);
    const double u = 640.0 * uniform(rng) - 320.0, v = 480.0 * uniform(rng) - 240.0;
    const bool is_inlier = uniform(rng) >= options.outlier_ratio;
    Eigen::Vector3d p_camera(u / options.focal_px * z, v / options.focal_px * z, z);
    if (!is_inlier) {
      const double other_z = 0.7 + 3.8 * uniform(rng);
      p_camera << (1.2 * uniform(rng) - 0.6) * other_z, (0.9 * uniform(rng) - 0.45) * other_z, other_z;
    }
    const Eigen::Vector3d p_map = scene.T_map_camera * p_camera;
    const double x = (u + options.noise_px * normal(rng)) / options.assumed_focal_px;
    const double y = (v + options.noise_px * normal(rng)) / options.assumed_focal_px;
    const double depth = z + options.depth_noise.sigma_m(z) * normal(rng);
    const double rank = options.is_rank_informative ? uniform(rng) + (is_inlier ? 0.0 : 0.5) : uniform(rng);
    scene.pairs.add(static_cast<float>(x), static_cast<float>(y), static_cast<float>(p_map.x()), static_cast<float>(p_map.y()),
                    static_cast<float>(p_map.z()), options.has_depth ? static_cast<float>(depth) : 0.0F,
                    static_cast<float>(options.noise_px > 0.0 ? options.noise_px : 1.0), static_cast<float>(rank), i, i);
    scene.is_inlier.push_back(is_inlier ? 1 : 0);
  }
  scene.pairs.sort_by_rank();
  return scene;
}

/// A start for the refinement: the true pose moved by about this much per axis.
inline Rigid3 disturbed(std::mt19937& rng, const Rigid3& T_map_camera, double position_sigma_m, double rotation_sigma_rad) {
  const Eigen::Vector3d step = random_vector(rng, position_sigma_m), turn = random_vector(rng, rotation_sigma_rad);
  return {exp_so3(turn) * T_map_camera.rotation, T_map_camera.translation + step};
}

}  // namespace camloc::testing
