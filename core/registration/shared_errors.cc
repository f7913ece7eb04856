// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// In camera axes a landmark at p that is moved by d and a pose that is off by (t, r) change the landmark's place in the camera by
// d - t + p x r. With M the information about that place (two rows of the pixel, one of the depth) and D = (-1, [p]x), the landmark adds
// D'MD to the Gauss-Newton matrix and D'M to the derivative of the gradient by d.
#include "core/registration/shared_errors.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

namespace camloc {
namespace {

constexpr double kPartSize = 0.3;  // normalized image coordinates
constexpr int kPartsPerAxis = 8;   // the outermost take what lies beyond
constexpr double kMinDepth_m = 0.05;
constexpr double kMaxDepthErrorSigmas = 4;  // as in the refinement: a depth farther off took no part

using Matrix63d = Eigen::Matrix<double, 6, 3>;

std::size_t part_of(double x_normalized, double y_normalized) {
  const auto along = [](double value) {
    return std::clamp(static_cast<int>(std::floor(value / kPartSize)) + kPartsPerAxis / 2, 0, kPartsPerAxis - 1);
  };
  return static_cast<std::size_t>(along(y_normalized) * kPartsPerAxis + along(x_normalized));
}

Eigen::Matrix3d information_of(const Eigen::Vector3d& p_camera, double sigma_px, double depth_m, const SharedErrorsModel& model) {
  Eigen::Matrix<double, 2, 3> projection;
  const double scale = model.focal_px / (p_camera.z() * (sigma_px > 0 ? sigma_px : 1.0));
  projection << scale, 0, -scale * p_camera.x() / p_camera.z(), 0, scale, -scale * p_camera.y() / p_camera.z();
  Eigen::Matrix3d information = projection.transpose() * projection;
  if (!model.use_depth || depth_m <= 0) return information;
  const double sigma_m = model.depth_noise.sigma_m(depth_m);
  if (std::abs(p_camera.z() - depth_m) <= kMaxDepthErrorSigmas * sigma_m) information(2, 2) += 1.0 / (sigma_m * sigma_m);
  return information;
}

/// A root of the covariance of a landmark's shared error: a view that is turned moves what it mapped across the line of sight only.
Eigen::Matrix3d shared_error_root(const Eigen::Vector3d& p_camera, const SharedErrors& errors) {
  const double distance_m = p_camera.norm();
  const double across_m = std::hypot(errors.sigma_m, errors.sigma_rad * distance_m);
  const Eigen::Vector3d along = p_camera / distance_m;
  return across_m * Eigen::Matrix3d::Identity() + (errors.sigma_m - across_m) * along * along.transpose();
}

}  // namespace

Matrix6d shared_error_covariance(const Correspondences& pairs, const std::vector<std::uint8_t>& inlier_mask, const Rigid3& T_map_camera,
                                 const SharedErrorsModel& model) {
  if (!(model.landmarks.sigma_m > 0) && !(model.landmarks.sigma_rad > 0)) return Matrix6d::Zero();
  std::array<Matrix63d, kPartsPerAxis * kPartsPerAxis> by_part;
  by_part.fill(Matrix63d::Zero());
  Matrix6d hessian = Matrix6d::Zero();
  const Eigen::Matrix3d R_camera_map = T_map_camera.rotation.conjugate().toRotationMatrix();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (inlier_mask[i] == 0) continue;
    const Eigen::Vector3d p = R_camera_map * (Eigen::Vector3d(pairs.X[i], pairs.Y[i], pairs.Z[i]) - T_map_camera.translation);
    if (p.z() <= kMinDepth_m) continue;
    Matrix63d d_transposed;
    d_transposed << -Eigen::Matrix3d::Identity(), -cross_matrix(p);
    const Matrix63d d_information = d_transposed * information_of(p, pairs.sigma_px[i], pairs.depth_m[i], model);
    hessian.noalias() += d_information * d_transposed.transpose();
    by_part[part_of(pairs.x[i], pairs.y[i])].noalias() += d_information * shared_error_root(p, model.landmarks);
  }
  const Eigen::LLT<Matrix6d> llt(hessian);
  if (llt.info() != Eigen::Success) return Matrix6d::Zero();
  Matrix6d covariance = Matrix6d::Zero();
  for (const Matrix63d& part : by_part) {
    if (part.isZero(0.0)) continue;
    const Matrix63d moved = llt.solve(part);
    covariance.noalias() += moved * moved.transpose();
  }
  if (!covariance.allFinite()) return Matrix6d::Zero();
  return rotate_covariance(T_map_camera.rotation, covariance);
}

}  // namespace camloc
