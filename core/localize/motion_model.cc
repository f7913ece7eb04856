// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/localize/motion_model.h"

#include <algorithm>
#include <cmath>

namespace camloc {
namespace {

double seconds(std::int64_t ns) { return 1e-9 * static_cast<double>(ns); }

/// Slack for what the poses themselves may be off.
constexpr double kPositionSlack = 0.25;
constexpr double kRotationSlack = 0.2;
/// Standard deviations of a prediction without a velocity, of those of one with it.
constexpr double kWithoutVelocity = 3;
/// Share of max_velocity_age_s.
constexpr double kFreshAge = 0.25;

}  // namespace

bool is_within_reach(const LocalizerNumbers& numbers, std::int64_t elapsed_ns, const Rigid3& T_map_from, const Rigid3& T_map_to) {
  const double dt = std::abs(seconds(elapsed_ns));
  const double distance = (T_map_to.translation - T_map_from.translation).norm();
  const double angle = rotation_distance_rad(T_map_to.rotation, T_map_from.rotation);
  return distance <= numbers.max_speed_m_per_s * dt + kPositionSlack && angle <= numbers.max_turn_rad_per_s * dt + kRotationSlack;
}

void MotionModel::add_fix(std::int64_t stamp_ns, const Rigid3& T_map_camera, const Matrix6d& covariance, bool is_continuous) {
  const std::int64_t elapsed_ns = stamp_ns - stamp_ns_;
  has_velocity_ = is_continuous && has_fix_ && elapsed_ns > 0 && seconds(elapsed_ns) <= numbers_.max_velocity_age_s;
  if (has_velocity_) {
    const Rigid3 T_last_now = T_map_camera_.inverse() * T_map_camera;
    velocity_camera_m_per_s_ = T_last_now.translation / seconds(elapsed_ns);
    turn_camera_rad_per_s_ = log_so3(T_last_now.rotation) / seconds(elapsed_ns);
  }
  has_fix_ = true;
  stamp_ns_ = stamp_ns;
  T_map_camera_ = T_map_camera;
  covariance_ = covariance;
}

Rigid3 MotionModel::predict(std::int64_t stamp_ns) const {
  if (!has_velocity_) return T_map_camera_;
  const double dt = std::min(seconds(stamp_ns - stamp_ns_), numbers_.max_velocity_age_s);
  return T_map_camera_ * Rigid3{exp_so3(turn_camera_rad_per_s_ * dt), velocity_camera_m_per_s_ * dt};
}

Matrix6d MotionModel::predict_covariance(std::int64_t stamp_ns) const {
  const double dt = std::max(0.0, seconds(stamp_ns - stamp_ns_));
  const double factor = has_velocity_ ? 1.0 : kWithoutVelocity;
  Matrix6d covariance = covariance_;
  const double position = factor * numbers_.speed_change_m_per_s * dt;
  const double rotation = factor * numbers_.turn_change_rad_per_s * dt;
  covariance.diagonal().head<3>().array() += position * position;
  covariance.diagonal().tail<3>().array() += rotation * rotation;
  return covariance;
}

// The longer ago the last pose, the less its velocity says; after max_velocity_age_s it says nothing. Between the frames of a camera
// that runs it is fresh.
double MotionModel::fading(std::int64_t stamp_ns) const {
  if (!has_velocity_) return 1;
  const double age = seconds(stamp_ns - stamp_ns_) / numbers_.max_velocity_age_s;
  return 1 + std::clamp((age - kFreshAge) / (1 - kFreshAge), 0.0, 1.0) * (kWithoutVelocity - 1);
}

bool MotionModel::is_expected(std::int64_t stamp_ns, const Rigid3& T_map_camera, const Matrix6d& covariance) const {
  if (!has_fix_) return true;
  const Vector6d error = pose_error(T_map_camera, predict(stamp_ns));
  const Vector6d variance = (predict_covariance(stamp_ns) + covariance).diagonal();
  const double sigmas = numbers_.expected_sigmas * fading(stamp_ns);
  const double limit = sigmas * sigmas;
  return error.head<3>().squaredNorm() <= limit * variance.head<3>().maxCoeff() &&
         error.tail<3>().squaredNorm() <= limit * variance.tail<3>().maxCoeff();
}

bool MotionModel::is_plausible(std::int64_t stamp_ns, const Rigid3& T_map_camera) const {
  return !has_fix_ || is_within_reach(numbers_, stamp_ns - stamp_ns_, T_map_camera_, T_map_camera);
}

}  // namespace camloc
