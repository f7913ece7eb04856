// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What the numbers of a map may be. Right hashes are no promise: a pose sigma of 1e200 m gives an infinite covariance, and an indefinite
// covariance of the datum a negative variance. Reader and writer ask the same questions, so that what is written can be read.
#pragma once

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>

#include "core/geometry/rigid3.h"

namespace camloc::map_ranges {

constexpr double kMaxPosition_m = 1e6;     ///< of landmarks and keyframes in `map`; floats are good to 6 cm there
constexpr double kMaxWcsPosition_m = 1e8;  ///< beyond every geocentric or projected coordinate on Earth
constexpr double kMaxPoseSigma_m = 1e3;
constexpr double kMaxSigma_rad = std::numbers::pi;

/// False for NaN.
[[nodiscard]] inline bool is_within(double value, double largest) { return std::abs(value) <= largest; }

[[nodiscard]] inline bool are_pose_sigmas(double sigma_m, double sigma_rad) {
  return sigma_m >= 0 && sigma_m <= kMaxPoseSigma_m && sigma_rad >= 0 && sigma_rad <= kMaxSigma_rad;
}

/// Whether `covariance`, of metres then radians, is finite, symmetric and positive semi-definite to rounding, with variances of at most
/// `max_sigma_m` squared and kMaxSigma_rad squared. Asked of the correlations, because the units of the two halves differ.
[[nodiscard]] inline bool is_covariance(const Matrix6d& covariance, double max_sigma_m) {
  constexpr double kRounding = 1e-6, kTiny = 1e-12;  // a micrometre, a microradian: below, all is rounding
  if (!covariance.allFinite()) return false;
  Matrix6d correlation;
  for (int row = 0; row < 6; ++row) {
    const double max_sigma = row < 3 ? max_sigma_m : kMaxSigma_rad;
    if (!(covariance(row, row) >= 0 && covariance(row, row) <= max_sigma * max_sigma)) return false;
    for (int column = 0; column < 6; ++column) {
      correlation(row, column) = covariance(row, column) / std::sqrt((covariance(row, row) + kTiny) * (covariance(column, column) + kTiny));
    }
  }
  if (!correlation.isApprox(correlation.transpose(), kRounding)) return false;
  return Eigen::SelfAdjointEigenSolver<Matrix6d>(correlation, Eigen::EigenvaluesOnly).eigenvalues().minCoeff() >= -kRounding;
}

}  // namespace camloc::map_ranges
