// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/rigid3.h"

#include <Eigen/SVD>
#include <cmath>

namespace camloc {

Rigid3 Rigid3::inverse() const {
  const Eigen::Quaterniond inverse_rotation = rotation.conjugate();
  return {inverse_rotation, -(inverse_rotation * translation)};
}

Eigen::Matrix4d Rigid3::matrix() const {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = rotation.toRotationMatrix();
  m.topRightCorner<3, 1>() = translation;
  return m;
}

Rigid3 operator*(const Rigid3& T_a_b, const Rigid3& T_b_c) {
  // Normalized so that long products stay rotations.
  return {(T_a_b.rotation * T_b_c.rotation).normalized(), T_a_b.rotation * T_b_c.translation + T_a_b.translation};
}

Eigen::Vector3d operator*(const Rigid3& T_a_b, const Eigen::Vector3d& p_b) { return T_a_b.rotation * p_b + T_a_b.translation; }

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Eigen::Quaterniond exp_so3(const Eigen::Vector3d& rotation_vector_rad) {
  const double angle_squared = rotation_vector_rad.squaredNorm();
  // Below 1e-4 rad the third term of either series is under the last bit of a double.
  if (angle_squared < 1e-8) {
    const double scale = 0.5 - angle_squared / 48.0;
    const Eigen::Vector3d v = scale * rotation_vector_rad;
    return Eigen::Quaterniond(1.0 - angle_squared / 8.0, v.x(), v.y(), v.z()).normalized();
  }
  const double angle = std::sqrt(angle_squared);
  const Eigen::Vector3d v = std::sin(0.5 * angle) / angle * rotation_vector_rad;
  return {std::cos(0.5 * angle), v.x(), v.y(), v.z()};
}

Eigen::Vector3d log_so3(const Eigen::Quaterniond& rotation) {
  const double sign = rotation.w() < 0 ? -1.0 : 1.0;  // q and -q are one rotation: take the one below half a turn
  const double sine = rotation.vec().norm();
  const double cosine = sign * rotation.w();
  if (sine < 1e-8) return 2.0 * sign / cosine * rotation.vec();
  return 2.0 * sign * std::atan2(sine, cosine) / sine * rotation.vec();
}

Eigen::Quaterniond nearest_rotation(const Eigen::Matrix3d& almost_rotation) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(almost_rotation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs = Eigen::Vector3d::Ones();
  if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0) signs.z() = -1.0;
  const Eigen::Matrix3d rotation = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  return Eigen::Quaterniond(rotation).normalized();
}

Eigen::Quaterniond shortest_turn(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  constexpr double kOpposite = 1e-12;
  const double cosine = from.dot(to);
  if (cosine < kOpposite - 1) {
    const Eigen::Vector3d axis = from.unitOrthogonal();
    return {0, axis.x(), axis.y(), axis.z()};
  }
  const double s = std::sqrt(2 * (1 + cosine));  // twice the cosine of half the angle
  const Eigen::Vector3d v = from.cross(to) / s;
  return Eigen::Quaterniond(s / 2, v.x(), v.y(), v.z()).normalized();
}

double rotation_distance_rad(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) { return log_so3(a.conjugate() * b).norm(); }

Vector6d pose_error(const Rigid3& T_map_camera_true, const Rigid3& T_map_camera_estimate) {
  Vector6d error;
  error.head<3>() = T_map_camera_true.translation - T_map_camera_estimate.translation;
  error.tail<3>() = log_so3(T_map_camera_true.rotation * T_map_camera_estimate.rotation.conjugate());
  return error;
}

Matrix6d rotate_covariance(const Eigen::Quaterniond& R_a_b, const Matrix6d& covariance_b) {
  Matrix6d turn = Matrix6d::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = R_a_b.toRotationMatrix();
  return turn * covariance_b * turn.transpose();
}

Rigid3 interpolate(const Rigid3& from, const Rigid3& to, double fraction) {
  const Eigen::Vector3d turn = log_so3(to.rotation * from.rotation.conjugate());
  return {(exp_so3(fraction * turn) * from.rotation).normalized(), from.translation + fraction * (to.translation - from.translation)};
}

}  // namespace camloc
