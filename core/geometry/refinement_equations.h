// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Inside of pose_refinement.cc: cost, gradient and Gauss-Newton matrix of one pose over all pairs, four pairs at a time.
// This is where the refinement spends its time.
#pragma once

#include <Eigen/Core>

#include "core/geometry/camera.h"
#include "core/geometry/correspondences.h"
#include "core/geometry/rigid3.h"

namespace camloc {

/// Both kernels are constant beyond their reach, so that pairs may leave and enter without the cost jumping.
enum class RobustKernel { kCauchy, kTruncated };

struct RefinementModel {
  double focal_px = 1;
  DepthNoise depth_noise;
  bool use_depth = true;
  RobustKernel kernel = RobustKernel::kCauchy;
  double cauchy_scale = 2;         ///< of the normalized residual
  double reach_px = 25;            ///< of a reprojection error
  double reach_depth_sigmas = 20;  ///< of a depth error
};

/// Landmarks nearer than this, or behind the camera, take no part.
inline constexpr double kMinRefinementDepth_m = 0.05;

/// Sum of the losses in sigmas^2 with its gradient (half of it: J'r) and Gauss-Newton matrix J'J; N = 6: pose in camera axes
/// (see pose_jacobian.h), N = 7: the focal scale besides.
template <int N>
struct NormalEquations {
  double cost = 0;
  Eigen::Matrix<double, N, 1> gradient = Eigen::Matrix<double, N, 1>::Zero();
  Eigen::Matrix<double, N, N> hessian = Eigen::Matrix<double, N, N>::Zero();
};

/// A pair counts where its landmark lies in front and its reprojection error is in reach; its depth counts where that is so
/// and the depth error is in reach, too. Every instruction set gives the same bits.
template <int N>
[[nodiscard]] NormalEquations<N> normal_equations(const Correspondences& pairs, const RefinementModel& model, const Rigid3& T_map_camera,
                                                  double focal_scale);

extern template NormalEquations<6> normal_equations<6>(const Correspondences&, const RefinementModel&, const Rigid3&, double);
extern template NormalEquations<7> normal_equations<7>(const Correspondences&, const RefinementModel&, const Rigid3&, double);

}  // namespace camloc
