// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Extended bundle adjustment: camera poses and landmarks that fit all observations best, where the measured depth is an
// observation of its own beside the reprojection error ("Camera localization for augmented reality and indoor positioning",
// 2019), with a standard deviation that grows with the square of the distance. The cost, with a robust kernel rho over each
// whitened residual,
//     sum over observations of  rho_px(|f (x - x_predicted)|^2 / sigma_px^2) + rho_depth((depth - z)^2 / sigma(z)^2)
//   + sum over point priors of  |p - p_prior|^2 / sigma^2
//   + sum over links of  rho_link(|pose_error|^2 in the metric of its covariance)
//   + what further terms on poses add (terms/pose_terms.h)
// is minimized by Levenberg-Marquardt on the Schur complement (Triggs, McLauchlan, Hartley, Fitzgibbon, "Bundle adjustment -
// a modern synthesis", 2000): the landmarks are eliminated, what remains is a system over the cameras, dense where they are
// few and sparse where they are many. The scale of the depth is never free: without an absolute reference a free scale
// shrinks the map to a point.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/optimize/bundle_problem.h"

namespace camloc {

struct BundleReport {
  int num_iterations = 0;
  double initial_cost = 0, final_cost = 0;
  bool is_sparse = false;
  bool is_converged = false;
  bool is_stopped = false;  ///< on_iteration said so
};

/// What an observation is off by, in its own standard deviations.
struct BundleResidual {
  float pixel_sigmas = 0;  ///< |f (x - x_predicted)| / sigma_px; 1e9 behind the camera
  float depth_sigmas = 0;  ///< signed, (depth - z) / sigma(z); 0 without depth
};

/// Called after every iteration with its number and cost; return false to stop with the best state so far.
using BundleCallback = std::function<bool(int iteration, double cost)>;

/// Adjusts poses and landmarks in place. Fix at least one camera or give three priors, or the gauge is free (the damping
/// keeps the solution near where it was).
///  - sigma(z) is taken at the measured depth. A sigma_px that is not positive and finite counts as 1.
///  - A landmark with one observation and no prior moves no camera: with depth it ends where that observation puts it, without
///    it is left alone.
///  - An observation whose landmark is behind the camera (nearer than 5 cm), more than 45 degrees off, or not finite takes no
///    part for as long as that is so, at the cost it would have at 45 degrees. Depths and priors that are not positive and
///    finite are ignored.
///  - A link of a camera with itself, or one that is not finite or has no positive definite covariance, takes no part.
///  - The kernels are applied by iteratively reweighted least squares: with many gross outliers the last permille of the cost
///    takes many iterations, so take outliers out by bundle_residuals() and adjust again.
/// Besides the problem, memory is a second copy of poses and landmarks and the reduced system, whose blocks (288 bytes) are
/// pairs of cameras with a common landmark and their fill-in; nothing is kept per observation. The same problem gives the same
/// bits.
BundleReport adjust_bundle(const BundleOptions& options, BundleProblem* problem, const BundleCallback& on_iteration = {});

/// Residuals at the current state, one per observation.
[[nodiscard]] std::vector<BundleResidual> bundle_residuals(const BundleOptions& options, const BundleProblem& problem);

}  // namespace camloc
