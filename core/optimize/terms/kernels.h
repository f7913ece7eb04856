// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Robust kernels over a squared residual in standard deviations: what it costs, and the factor of its weight in iteratively
// reweighted least squares.
#pragma once

#include <cmath>
#include <limits>

namespace camloc {

struct RobustCost {
  double cost, weight;
};

/// Quadratic up to `width` standard deviations, linear beyond (Huber, "Robust estimation of a location parameter", 1964).
[[nodiscard]] inline RobustCost huber(double squared, double width) {
  const double inner = width * width;
  if (squared <= inner) return {squared, 1.0};
  const double length = std::sqrt(squared);
  return {2.0 * width * length - inner, width / length};
}

/// Cauchy's kernel, which lets go of gross outliers; no kernel where `width` is 0. What is not finite takes no part.
[[nodiscard]] inline RobustCost cauchy(double squared, double width) {
  if (!(squared < std::numeric_limits<double>::infinity())) return {0.0, 0.0};
  if (!(width > 0)) return {squared, 1.0};
  const double inner = width * width;
  return {inner * std::log1p(squared / inner), 1.0 / (1.0 + squared / inner)};
}

}  // namespace camloc
