// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/symmetric_system.h"

#include <Eigen/Cholesky>

namespace camloc {

template <int N>
Eigen::Matrix<double, N, 1> solve_symmetric(const Eigen::Matrix<double, N, N>& A, const Eigen::Matrix<double, N, 1>& b) {
  return A.ldlt().solve(b);
}

template Eigen::Vector2d solve_symmetric<2>(const Eigen::Matrix2d&, const Eigen::Vector2d&);
template Eigen::Vector3d solve_symmetric<3>(const Eigen::Matrix3d&, const Eigen::Vector3d&);
template Eigen::Vector4d solve_symmetric<4>(const Eigen::Matrix4d&, const Eigen::Vector4d&);
template Eigen::Matrix<double, 6, 1> solve_symmetric<6>(const Eigen::Matrix<double, 6, 6>&, const Eigen::Matrix<double, 6, 1>&);
template Eigen::Matrix<double, 7, 1> solve_symmetric<7>(const Eigen::Matrix<double, 7, 7>&, const Eigen::Matrix<double, 7, 1>&);
template Eigen::Matrix<double, 8, 1> solve_symmetric<8>(const Eigen::Matrix<double, 8, 8>&, const Eigen::Matrix<double, 8, 1>&);

double squared_mahalanobis(const Eigen::Matrix<double, 6, 1>& error, const Eigen::Matrix<double, 6, 6>& covariance) {
  return error.dot(solve_symmetric<6>(covariance, error));
}

}  // namespace camloc
