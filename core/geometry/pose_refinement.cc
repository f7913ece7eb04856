// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Levenberg-Marquardt over one pose, with depth as an observation of its own.
#include "core/geometry/pose_refinement.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/geometry/pose_jacobian.h"

namespace camloc {
namespace {

constexpr double kMinDepth_m = 0.05;          // landmarks nearer or behind the camera take no part
constexpr double kCauchyReach = 5.0;          // the Cauchy pass sees pairs within this many times max_error_px
constexpr double kCauchyReachFocal = 20.0;    // a wrong focal length moves the border of the image by tens of pixels
constexpr double kCauchyDepthReach = 20.0;    // sigmas; beyond, a depth adds a constant
constexpr double kMinFocalScale = 0.3, kMaxFocalScale = 3.0;
constexpr std::size_t kMinInliers = 4;

enum class Kernel { kCauchy, kTruncated };

struct State {
  Rigid3 T_map_camera;
  double focal_scale = 1.0;
};

/// Everything a pair says at one state.
struct Residual {
  bool is_in_front = false;
  bool has_depth = false;
  double u = 0, v = 0, z = 0;    ///< predicted: normalized coordinates and depth
  double du_px = 0, dv_px = 0;   ///< predicted minus measured
  double error_squared_px = 0;
  double sigma_px = 1;
  double depth_sigmas = 0;       ///< predicted minus measured, in sigmas
  double depth_sigma_m = 1;
};

class Problem {
 public:
  Problem(const Correspondences& pairs, double focal_px, const PoseRefinementOptions& options)
      : pairs_(pairs), focal_px_(focal_px), options_(options) {}

  [[nodiscard]] const Correspondences& pairs() const { return pairs_; }
  [[nodiscard]] const PoseRefinementOptions& options() const { return options_; }
  [[nodiscard]] double focal_px() const { return focal_px_; }

  [[nodiscard]] Residual residual(std::size_t i, const Eigen::Matrix3d& R_camera_map, const State& state) const {
    Residual r;
    const Eigen::Vector3d p_map(pairs_.X[i], pairs_.Y[i], pairs_.Z[i]);
    const Eigen::Vector3d p = R_camera_map * (p_map - state.T_map_camera.translation);
    r.is_in_front = p.z() > kMinDepth_m;
    if (!r.is_in_front) return r;
    r.z = p.z();
    r.u = p.x() / p.z();
    r.v = p.y() / p.z();
    r.du_px = focal_px_ * (state.focal_scale * r.u - pairs_.x[i]);
    r.dv_px = focal_px_ * (state.focal_scale * r.v - pairs_.y[i]);
    r.error_squared_px = r.du_px * r.du_px + r.dv_px * r.dv_px;
    r.sigma_px = sigma_px(i);
    r.has_depth = has_depth(i);
    if (r.has_depth) {
      const double measured_m = pairs_.depth_m[i];
      r.depth_sigma_m = options_.depth_noise.sigma_m(measured_m);
      r.depth_sigmas = (r.z - measured_m) / r.depth_sigma_m;
    }
    return r;
  }

  [[nodiscard]] bool has_depth(std::size_t i) const { return options_.use_depth && pairs_.depth_m[i] > 0.0F; }
  [[nodiscard]] double sigma_px(std::size_t i) const { return pairs_.sigma_px[i] > 0.0F ? pairs_.sigma_px[i] : 1.0; }

 private:
  const Correspondences& pairs_;
  double focal_px_;
  PoseRefinementOptions options_;
};

/// Cost and weight of one residual given its squared size in sigmas; both kernels are constant beyond their reach, so
/// that pairs may leave and enter without the cost jumping.
struct Loss {
  double cost = 0, weight = 0;
};

Loss loss_of(Kernel kernel, double squared, double squared_reach, double cauchy_scale) {
  const bool is_within = squared <= squared_reach;
  const double limited = is_within ? squared : squared_reach;
  if (kernel == Kernel::kTruncated) return {limited, is_within ? 1.0 : 0.0};
  const double c2 = cauchy_scale * cauchy_scale;
  return {c2 * std::log1p(limited / c2), is_within ? 1.0 / (1.0 + limited / c2) : 0.0};
}

/// Sum of the losses with its gradient and Gauss-Newton matrix; N = 6 pose in camera axes, 7th the focal scale.
template <int N>
struct NormalEquations {
  using Vector = Eigen::Matrix<double, N, 1>;
  using Matrix = Eigen::Matrix<double, N, N>;
  double cost = 0;
  Vector gradient = Vector::Zero();
  Matrix hessian = Matrix::Zero();

  void add(const Vector& row, double residual, double weight) {
    const Vector weighted = weight * row;
    gradient.noalias() += residual * weighted;
    hessian.noalias() += weighted * row.transpose();
  }
};

template <int N>
void add_pair(const Problem& problem, const Residual& r, const State& state, double pixel_weight, double depth_weight,
              NormalEquations<N>* equations) {
  using Vector = typename NormalEquations<N>::Vector;
  const PointJacobian J = point_jacobian(r.u, r.v, r.z);
  const double scale = problem.focal_px() * state.focal_scale;
  Vector row_u = Vector::Zero(), row_v = Vector::Zero(), row_z = Vector::Zero();
  row_u.template head<6>() = scale * J.u;
  row_v.template head<6>() = scale * J.v;
  row_z.template head<6>() = J.z;
  if constexpr (N == 7) {
    row_u[6] = problem.focal_px() * r.u;
    row_v[6] = problem.focal_px() * r.v;
  }
  if (pixel_weight > 0.0) {
    const double weight = pixel_weight / (r.sigma_px * r.sigma_px);
    equations->add(row_u, r.du_px, weight);
    equations->add(row_v, r.dv_px, weight);
  }
  if (depth_weight > 0.0) {
    equations->add(row_z, r.depth_sigmas * r.depth_sigma_m, depth_weight / (r.depth_sigma_m * r.depth_sigma_m));
  }
}

template <int N>
NormalEquations<N> evaluate(const Problem& problem, const State& state, Kernel kernel) {
  NormalEquations<N> equations;
  const PoseRefinementOptions& options = problem.options();
  const Eigen::Matrix3d R_camera_map = state.T_map_camera.rotation.conjugate().toRotationMatrix();
  const double cauchy_reach = N == 7 ? kCauchyReachFocal : kCauchyReach;
  const double reach_px = kernel == Kernel::kCauchy ? cauchy_reach * options.max_error_px : options.max_error_px;
  const double depth_reach = kernel == Kernel::kCauchy ? kCauchyDepthReach : options.max_depth_error_sigmas;
  const double squared_depth_reach = depth_reach * depth_reach;
  for (std::size_t i = 0; i < problem.pairs().size(); ++i) {
    const Residual r = problem.residual(i, R_camera_map, state);
    const double sigma_px = problem.sigma_px(i);
    const double squared_reach = reach_px * reach_px / (sigma_px * sigma_px);
    const double squared = r.is_in_front ? r.error_squared_px / (sigma_px * sigma_px) : 2.0 * squared_reach;
    const Loss pixel = loss_of(kernel, squared, squared_reach, options.cauchy_scale);
    equations.cost += pixel.cost;
    Loss depth;
    if (problem.has_depth(i)) {
      // The depth of a pair whose pixel is out of reach says nothing about this pose.
      const double squared_depth = pixel.weight > 0.0 ? r.depth_sigmas * r.depth_sigmas : 2.0 * squared_depth_reach;
      depth = loss_of(kernel, squared_depth, squared_depth_reach, options.cauchy_scale);
      equations.cost += depth.cost;
    }
    if (pixel.weight > 0.0) add_pair<N>(problem, r, state, pixel.weight, depth.weight, &equations);
  }
  return equations;
}

template <int N>
State moved(const State& state, const Eigen::Matrix<double, N, 1>& change) {
  State next = state;
  next.T_map_camera = moved_in_camera_axes(state.T_map_camera, change.template head<6>());
  if constexpr (N == 7) next.focal_scale = std::clamp(state.focal_scale + change[6], kMinFocalScale, kMaxFocalScale);
  return next;
}

/// Runs one pass from `state`; returns the equations at the state it ends in.
template <int N>
NormalEquations<N> minimize(const Problem& problem, Kernel kernel, State* state) {
  NormalEquations<N> here = evaluate<N>(problem, *state, kernel);
  double damping = 1e-4;
  for (int iteration = 0; iteration < problem.options().max_iterations; ++iteration) {
    typename NormalEquations<N>::Matrix damped = here.hessian;
    damped.diagonal() *= 1.0 + damping;
    damped.diagonal().array() += 1e-9;
    const Eigen::Matrix<double, N, 1> change = -damped.ldlt().solve(here.gradient);
    if (!change.allFinite() || change.template lpNorm<Eigen::Infinity>() < 1e-8) break;
    const State candidate = moved<N>(*state, change);
    const NormalEquations<N> there = evaluate<N>(problem, candidate, kernel);
    if (there.cost <= here.cost) {
      const bool is_settled = here.cost - there.cost < 1e-7 * here.cost;
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
  const std::size_t n = problem.pairs().size();
  const std::size_t stride = n / kMaxForMedian + 1;
  const Eigen::Matrix3d R_camera_map = state.T_map_camera.rotation.conjugate().toRotationMatrix();
  const double max_squared_px = problem.options().max_error_px * problem.options().max_error_px;
  double sum_px = 0, sum_sigmas = 0, sum_depth_sigmas = 0, sum_relative = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Residual r = problem.residual(i, R_camera_map, state);
    const bool is_inlier = r.is_in_front && r.error_squared_px <= max_squared_px;
    if (inlier_mask != nullptr) (*inlier_mask)[i] = is_inlier ? 1 : 0;
    if (!is_inlier) continue;
    if (static_cast<std::size_t>(result->num_inliers++) % stride == 0) errors[num_errors++] = static_cast<float>(r.error_squared_px);
    sum_px += r.error_squared_px;
    sum_sigmas += r.error_squared_px / (r.sigma_px * r.sigma_px);
    if (problem.pairs().depth_m[i] <= 0.0F) continue;
    ++result->num_with_depth;
    sum_relative += (problem.pairs().depth_m[i] - r.z) / r.z;
    const double depth_sigmas = (r.z - problem.pairs().depth_m[i]) / problem.options().depth_noise.sigma_m(problem.pairs().depth_m[i]);
    if (std::abs(depth_sigmas) > problem.options().max_depth_error_sigmas) continue;
    ++result->num_depth_inliers;
    sum_depth_sigmas += depth_sigmas * depth_sigmas;
  }
  if (num_errors > 0) {
    float* const middle = errors.data() + num_errors / 2;
    std::nth_element(errors.data(), middle, errors.data() + num_errors);
    result->median_px = std::sqrt(static_cast<double>(*middle));
    result->rms_px = std::sqrt(sum_px / result->num_inliers);
  }
  if (result->num_with_depth > 0) result->mean_relative_depth_error = sum_relative / result->num_with_depth;
  if (result->num_depth_inliers > 0) result->rms_depth_sigmas = std::sqrt(sum_depth_sigmas / result->num_depth_inliers);
  return sum_sigmas + (problem.options().use_depth ? sum_depth_sigmas : 0.0);
}

template <int N>
PoseRefinementResult refine(const Problem& problem, const Rigid3& T_map_camera_start, std::vector<std::uint8_t>* inlier_mask) {
  State state{T_map_camera_start, 1.0};
  minimize<N>(problem, Kernel::kCauchy, &state);
  const NormalEquations<N> final_equations = minimize<N>(problem, Kernel::kTruncated, &state);

  PoseRefinementResult result;
  const double sum_squares = collect_statistics(problem, state, &result, inlier_mask);
  result.T_map_camera = state.T_map_camera;
  result.focal_scale = state.focal_scale;
  const Eigen::LLT<typename NormalEquations<N>::Matrix> llt(final_equations.hessian);
  const int num_residuals = 2 * result.num_inliers + (problem.options().use_depth ? result.num_depth_inliers : 0);
  if (static_cast<std::size_t>(result.num_inliers) < kMinInliers || num_residuals <= N || llt.info() != Eigen::Success) return result;

  // Residuals larger than the noise model says widen the covariance; smaller ones never shrink it.
  const double reduced_chi_squared = sum_squares / (num_residuals - N);
  typename NormalEquations<N>::Matrix covariance = NormalEquations<N>::Matrix::Identity();
  llt.solveInPlace(covariance);
  covariance *= std::max(1.0, reduced_chi_squared);
  if (!covariance.allFinite() || !(covariance.diagonal().minCoeff() > 0.0)) return result;

  Matrix6d to_map_axes = Matrix6d::Zero();
  to_map_axes.topLeftCorner<3, 3>() = state.T_map_camera.rotation.toRotationMatrix();
  to_map_axes.bottomRightCorner<3, 3>() = to_map_axes.topLeftCorner<3, 3>();
  const Matrix6d in_map = to_map_axes * covariance.template topLeftCorner<6, 6>() * to_map_axes.transpose();
  result.covariance = 0.5 * (in_map + in_map.transpose());
  if constexpr (N == 7) result.focal_scale_sigma = std::sqrt(covariance(6, 6));
  result.is_converged = true;
  return result;
}

}  // namespace

PoseRefinementResult refine_pose(const Correspondences& pairs, const Rigid3& T_map_camera_start, double focal_px,
                                 const PoseRefinementOptions& options, std::vector<std::uint8_t>* inlier_mask) {
  if (inlier_mask != nullptr) inlier_mask->assign(pairs.size(), 0);
  const Problem problem(pairs, focal_px, options);
  return options.estimate_focal_scale ? refine<7>(problem, T_map_camera_start, inlier_mask)
                                      : refine<6>(problem, T_map_camera_start, inlier_mask);
}

}  // namespace camloc
