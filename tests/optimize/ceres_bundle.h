// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The cost of adjust_bundle() written for Ceres with automatic derivatives, as an oracle in tests and for comparison in the
// benchmark. Ceres is linked to neither core nor tools.
#pragma once

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <array>
#include <vector>

#include "core/optimize/bundle_adjustment.h"

namespace camloc::testing {

/// A camera as Ceres sees it: rotation vector of R_camera_map, then translation of T_camera_map.
using CeresCamera = std::array<double, 6>;

struct CeresPixelCost {
  double x, y, scale;
  template <class T>
  bool operator()(const T* camera, const T* X, T* residual) const {
    T p[3];
    ceres::AngleAxisRotatePoint(camera, X, p);
    for (int i = 0; i < 3; ++i) p[i] += camera[3 + i];
    residual[0] = scale * (p[0] / p[2] - x);
    residual[1] = scale * (p[1] / p[2] - y);
    return true;
  }
};

struct CeresDepthCost {
  double depth_m, scale;
  template <class T>
  bool operator()(const T* camera, const T* X, T* residual) const {
    T p[3];
    ceres::AngleAxisRotatePoint(camera, X, p);
    residual[0] = scale * (p[2] + camera[5] - depth_m);
    return true;
  }
};

inline CeresCamera ceres_camera(const Rigid3& T_map_camera) {
  const Rigid3 T_camera_map = T_map_camera.inverse();
  const Eigen::Vector3d r = log_so3(T_camera_map.rotation), t = T_camera_map.translation;
  return {r[0], r[1], r[2], t[0], t[1], t[2]};
}

inline Rigid3 pose_of(const CeresCamera& camera) {
  return Rigid3{exp_so3({camera[0], camera[1], camera[2]}), {camera[3], camera[4], camera[5]}}.inverse();
}

/// The problem with everything Ceres needs of it. Landmarks with fewer than two observations are left out.
class CeresBundle {
 public:
  CeresBundle(const BundleOptions& options, const BundleProblem& problem)
      : landmarks_(problem.landmarks_m),
        pixel_loss_(options.pixel_kernel_sigmas),
        depth_loss_(options.depth_kernel_sigmas),
        problem_(problem_options()) {
    for (const Rigid3& T_map_camera : problem.T_map_camera) cameras_.push_back(ceres_camera(T_map_camera));
    std::vector<std::uint32_t> num_observations(landmarks_.size(), 0);
    for (const BundleObservation& o : problem.observations) ++num_observations[o.landmark];
    for (const BundleObservation& o : problem.observations) {
      if (num_observations[o.landmark] >= 2) add(options, o);
    }
    for (std::size_t i = 0; i < cameras_.size(); ++i) {
      if (problem.is_camera_fixed[i] != 0 && problem_.HasParameterBlock(cameras_[i].data())) {
        problem_.SetParameterBlockConstant(cameras_[i].data());
      }
    }
  }

  /// Ceres minimizes half of our cost.
  ceres::Solver::Summary solve(const BundleOptions& options, ceres::LinearSolverType solver) {
    ceres::Solver::Options ceres_options;
    ceres_options.linear_solver_type = solver;
    ceres_options.num_threads = 1;
    ceres_options.max_num_iterations = options.max_iterations;
    ceres_options.function_tolerance = options.min_relative_decrease;
    ceres_options.parameter_tolerance = 0;
    ceres_options.gradient_tolerance = 0;
    ceres::Solver::Summary summary;
    ceres::Solve(ceres_options, &problem_, &summary);
    return summary;
  }

  [[nodiscard]] std::vector<Rigid3> poses() const {
    std::vector<Rigid3> poses;
    for (const CeresCamera& camera : cameras_) poses.push_back(pose_of(camera));
    return poses;
  }

 private:
  static ceres::Problem::Options problem_options() {
    ceres::Problem::Options options;
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;  // one kernel serves all
    return options;
  }

  void add(const BundleOptions& options, const BundleObservation& o) {
    double* const camera = cameras_[o.camera].data();
    double* const X = landmarks_[o.landmark].data();
    auto* const pixel = new CeresPixelCost{o.x, o.y, options.focal_px / o.sigma_px};
    problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<CeresPixelCost, 2, 6, 3>(pixel), &pixel_loss_, camera, X);
    if (!options.use_depth || !(o.depth_m > 0)) return;
    auto* const depth = new CeresDepthCost{o.depth_m, 1.0 / options.depth_noise.sigma_m(o.depth_m)};
    problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<CeresDepthCost, 1, 6, 3>(depth), &depth_loss_, camera, X);
  }

  std::vector<CeresCamera> cameras_;
  std::vector<Eigen::Vector3d> landmarks_;
  ceres::HuberLoss pixel_loss_, depth_loss_;
  ceres::Problem problem_;
};

}  // namespace camloc::testing
