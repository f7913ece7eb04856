// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/pose_refinement.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/geometry/pose_jacobian.h"
#include "core/geometry/refinement_equations.h"
#include "core/geometry/symmetric_system.h"

namespace camloc {
namespace {

constexpr double kCauchyReach = 5.0;        // the Cauchy pass sees pairs within this many times max_error_px
constexpr double kCauchyReachFocal = 20.0;  // a wrong focal length moves the border of the image by tens of pixels
constexpr double kCauchyDepthReach = 20.0;  // sigmas; beyond, a depth adds a constant
constexpr double kMaxDepthErrorSigmas = 4;  // a depth residual farther off is left out (its pixel stays)
constexpr double kMinFocalScale = 0.3, kMaxFocalScale = 3.0;
constexpr double kSettled = 1e-7;  // share of the cost below which a step ends a pass
constexpr std::size_t kMinInliers = 4;

struct State {
  Rigid3 T_map_camera;
  double focal_scale = 1.0;
};

struct Problem {
  const Correspondences& pairs;
  double focal_px;
  const PoseRefinementOptions& options;
};

template <int N>
RefinementModel model_of(const Problem& problem, RobustKernel kernel) {
  RefinementModel model;
  model.focal_px = problem.focal_px;
  model.depth_noise = problem.options.depth_noise;
  model.use_depth = problem.options.use_depth;
  model.kernel = kernel;
  model.reach_px = problem.options.max_error_px;
  model.reach_depth_sigmas = kMaxDepthErrorSigmas;
  if (kernel == RobustKernel::kCauchy) {
    model.reach_px = (N == 7 ? kCauchyReachFocal : kCauchyReach) * problem.options.max_error_px;
    model.reach_depth_sigmas = kCauchyDepthReach;
  }
  return model;
}

template <int N>
State moved(const State& state, const Eigen::Matrix<double, N, 1>& change) {
  State next = state;
  next.T_map_camera = moved_in_camera_axes(state.T_map_camera, change.template head<6>());
  if constexpr (N == 7) next.focal_scale = std::clamp(state.focal_scale + change[6], kMinFocalScale, kMaxFocalScale);
  return next;
}

/// Runs one pass from `state`; returns the equations at the state it ends in, or one step of no account before it.
template <int N>
NormalEquations<N> minimize(const Problem& problem, RobustKernel kernel, State* state) {
  const RefinementModel model = model_of<N>(problem, kernel);
  const auto evaluate = [&](const State& at) { return normal_equations<N>(problem.pairs, model, at.T_map_camera, at.focal_scale); };
  NormalEquations<N> here = evaluate(*state);
  double damping = 1e-4;
  for (int iteration = 0; iteration < problem.options.max_iterations; ++iteration) {
    Eigen::Matrix<double, N, N> damped = here.hessian;
    damped.diagonal() *= 1.0 + damping;
    damped.diagonal().array() += 1e-9;
    const Eigen::Matrix<double, N, 1> change = -solve_symmetric<N>(damped, here.gradient);
    if (!change.allFinite() || change.template lpNorm<Eigen::Infinity>() < 1e-8) break;
    const State candidate = moved<N>(*state, change);
    // What the step promises, in sigmas^2. It is far below the uncertainty of the pose: not worth another evaluation.
    if (-here.gradient.dot(change) < kSettled * here.cost) {
      *state = candidate;
      break;
    }
    const NormalEquations<N> there = evaluate(candidate);
    if (there.cost <= here.cost) {
      const bool is_settled = here.cost - there.cost < kSettled * here.cost;
      *state = candidate;
      here = there;
      damping = std::max(0.1 * damping, 1e-9);
      if (is_settled) break;
    } else {
      damping *= 10.0;
      if (damping > 1e6) break;
    }
  }
  return here;
}

/// Counts, masks and sums over the inliers of the final state. Returns the sum of squares in sigmas.
double collect_statistics(const Problem& problem, const State& state, PoseRefinementResult* result,
                          std::vector<std::uint8_t>* inlier_mask) {
  constexpr std::size_t kMaxForMedian = 2048;
  std::array<float, kMaxForMedian> errors;  // every `stride`-th inlier when there are more
  std::size_t num_errors = 0;
  const Correspondences& pairs = problem.pairs;
  const std::size_t n = pairs.size();
  const std::size_t stride = n / kMaxForMedian + 1;
  const Eigen::Matrix3d R_camera_map = state.T_map_camera.rotation.conjugate().toRotationMatrix();
  const double max_squared_px = problem.options.max_error_px * problem.options.max_error_px;
  double sum_px = 0, sum_sigmas = 0, sum_squared_depth = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector3d p_map(pairs.X[i], pairs.Y[i], pairs.Z[i]);
    const Eigen::Vector3d p = R_camera_map * (p_map - state.T_map_camera.translation);
    const double du_px = problem.focal_px * (state.focal_scale * (p.x() / p.z()) - pairs.x[i]);
    const double dv_px = problem.focal_px * (state.focal_scale * (p.y() / p.z()) - pairs.y[i]);
    const double squared_px = du_px * du_px + dv_px * dv_px;
    const bool is_inlier = p.z() > kMinRefinementDepth_m && squared_px <= max_squared_px;
    if (inlier_mask != nullptr) (*inlier_mask)[i] = is_inlier ? 1 : 0;
    if (!is_inlier) continue;
    if (static_cast<std::size_t>(result->num_inliers++) % stride == 0) errors[num_errors++] = static_cast<float>(squared_px);
    const double sigma_px = pairs.sigma_px[i] > 0.0F ? pairs.sigma_px[i] : 1.0;
    sum_px += squared_px;
    sum_sigmas += squared_px / (sigma_px * sigma_px);
    const double measured_m = pairs.depth_m[i];
    if (measured_m <= 0) continue;
    ++result->num_with_depth;
    const double depth_sigmas = (p.z() - measured_m) / problem.options.depth_noise.sigma_m(measured_m);
    if (std::abs(depth_sigmas) > kMaxDepthErrorSigmas) continue;
    ++result->num_depth_inliers;
    sum_squared_depth += depth_sigmas * depth_sigmas;
  }
  if (num_errors > 0) {
    float* const middle = errors.data() + num_errors / 2;
    std::nth_element(errors.data(), middle, errors.data() + num_errors);
    result->median_px = std::sqrt(static_cast<double>(*middle));
    result->rms_px = std::sqrt(sum_px / result->num_inliers);
  }
  return sum_sigmas + (problem.options.use_depth ? sum_squared_depth : 0.0);
}

template <int N>
PoseRefinementResult refine(const Problem& problem, const Rigid3& T_map_camera_start, std::vector<std::uint8_t>* inlier_mask) {
  State state{T_map_camera_start, 1.0};
  minimize<N>(problem, RobustKernel::kCauchy, &state);
  const NormalEquations<N> final_equations = minimize<N>(problem, RobustKernel::kTruncated, &state);

  PoseRefinementResult result;
  const double sum_squares = collect_statistics(problem, state, &result, inlier_mask);
  result.T_map_camera = state.T_map_camera;
  result.focal_scale = state.focal_scale;
  const Eigen::LLT<Eigen::Matrix<double, N, N>> llt(final_equations.hessian);
  const int num_residuals = 2 * result.num_inliers + (problem.options.use_depth ? result.num_depth_inliers : 0);
  if (static_cast<std::size_t>(result.num_inliers) < kMinInliers || num_residuals <= N || llt.info() != Eigen::Success) return result;

  // Residuals larger than the noise model says widen the covariance; smaller ones never shrink it.
  const double reduced_chi_squared = sum_squares / (num_residuals - N);
  Eigen::Matrix<double, N, N> covariance = Eigen::Matrix<double, N, N>::Identity();
  llt.solveInPlace(covariance);
  covariance *= std::max(1.0, reduced_chi_squared);
  if (!covariance.allFinite() || !(covariance.diagonal().minCoeff() > 0.0)) return result;

  const Matrix6d in_map = rotate_covariance(state.T_map_camera.rotation, covariance.template topLeftCorner<6, 6>());
  result.covariance = 0.5 * (in_map + in_map.transpose());
  if constexpr (N == 7) result.focal_scale_sigma = std::sqrt(covariance(6, 6));
  result.is_converged = true;
  return result;
}

}  // namespace

PoseRefinementResult refine_pose(const Correspondences& pairs, const Rigid3& T_map_camera_start, double focal_px,
                                 const PoseRefinementOptions& options, std::vector<std::uint8_t>* inlier_mask) {
  if (inlier_mask != nullptr) inlier_mask->assign(pairs.size(), 0);
  const Problem problem{pairs, focal_px, options};
  return options.estimate_focal_scale ? refine<7>(problem, T_map_camera_start, inlier_mask)
                                      : refine<6>(problem, T_map_camera_start, inlier_mask);
}

}  // namespace camloc
