// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Rigid transforms, and the glossary of frames they go between. `T_a_b` is defined by p_a = T_a_b * p_b and by nothing
// else; neighbouring letters match in a product: T_a_c = T_a_b * T_b_c.
//
//   camera  colour camera, optical convention: x right, y down, z forward
//   depth   depth camera, same convention
//   body    the headset or robot that carries the camera
//   cube    a piece of the map whose coordinates have an origin of their own, axes as `map`
//   map     metric frame of the feature database
//   wcs     world coordinate system of the site: metres, axes of the survey that fixed it
//
// T_map_camera is the camera's pose in the map, its translation the camera centre.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace camloc {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

/// p_a = rotation * p_b + translation (metres).
struct Rigid3 {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  [[nodiscard]] Rigid3 inverse() const;
  [[nodiscard]] Eigen::Matrix4d matrix() const;
};

[[nodiscard]] Rigid3 operator*(const Rigid3& T_a_b, const Rigid3& T_b_c);
[[nodiscard]] Eigen::Vector3d operator*(const Rigid3& T_a_b, const Eigen::Vector3d& p_b);

/// cross_matrix(a) * b = a x b.
[[nodiscard]] Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v);

/// Rotation vector (axis times angle, radians) to quaternion and back; exact near zero.
[[nodiscard]] Eigen::Quaterniond exp_so3(const Eigen::Vector3d& rotation_vector_rad);
[[nodiscard]] Eigen::Vector3d log_so3(const Eigen::Quaterniond& rotation);

/// The closest rotation in the Frobenius sense; recorded pose files are orthonormal only to 4e-4.
[[nodiscard]] Eigen::Quaterniond nearest_rotation(const Eigen::Matrix3d& almost_rotation);

/// The smallest rotation that turns the unit vector `from` onto the unit vector `to`; about any axis where they are opposite.
[[nodiscard]] Eigen::Quaterniond shortest_turn(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

/// Angle of the relative rotation, radians in [0, pi].
[[nodiscard]] double rotation_distance_rad(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b);

/// Error of an estimate in the convention of every covariance in this project: first the position error in the axes of
/// `map` (metres), then the rotation vector of R_true * R_estimate^-1, also in the axes of `map` (radians).
[[nodiscard]] Vector6d pose_error(const Rigid3& T_map_camera_true, const Rigid3& T_map_camera_estimate);

/// The covariance of pose_error() in axes a for one in axes b.
[[nodiscard]] Matrix6d rotate_covariance(const Eigen::Quaterniond& R_a_b, const Matrix6d& covariance_b);

/// Shortest path in rotation, straight line in translation; fraction 0 gives `from`.
[[nodiscard]] Rigid3 interpolate(const Rigid3& from, const Rigid3& to, double fraction);

}  // namespace camloc
