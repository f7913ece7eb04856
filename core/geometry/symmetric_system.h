// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace camloc {

/// x of A x = b for a symmetric A of 2, 3, 4, 6, 7 or 8 unknowns that is at least semidefinite, by LDLT with pivots. Compiled once: it is
/// many seconds of every file that does it by itself.
template <int N>
[[nodiscard]] Eigen::Matrix<double, N, 1> solve_symmetric(const Eigen::Matrix<double, N, N>& A, const Eigen::Matrix<double, N, 1>& b);

/// error^T covariance^-1 error, as in NEES.
[[nodiscard]] double squared_mahalanobis(const Eigen::Matrix<double, 6, 1>& error, const Eigen::Matrix<double, 6, 6>& covariance);

}  // namespace camloc
