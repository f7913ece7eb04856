// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Where will the camera be at the next frame? Constant velocity in the camera's own axes, with an uncertainty that grows
// with the time since the last verified pose.
#pragma once

#include <cstdint>

#include "core/geometry/rigid3.h"
#include "core/localize/localizer_numbers.h"

namespace camloc {

/// Could the camera have gone from one pose to the other in that time?
[[nodiscard]] bool is_within_reach(const LocalizerNumbers& numbers, std::int64_t elapsed_ns, const Rigid3& T_map_from,
                                   const Rigid3& T_map_to);

class MotionModel {
 public:
  explicit MotionModel(const LocalizerNumbers& numbers) : numbers_(numbers) {}

  void reset() { *this = MotionModel(numbers_); }
  /// A verified pose. `is_continuous`: it follows the last one without a jump, so that both give a velocity.
  void add_fix(std::int64_t stamp_ns, const Rigid3& T_map_camera, const Matrix6d& covariance, bool is_continuous);

  [[nodiscard]] bool has_fix() const { return has_fix_; }
  [[nodiscard]] std::int64_t last_stamp_ns() const { return stamp_ns_; }
  [[nodiscard]] const Rigid3& last_fix() const { return T_map_camera_; }
  /// T_map_camera at a time after the last fix.
  [[nodiscard]] Rigid3 predict(std::int64_t stamp_ns) const;
  /// Covariance of that prediction, convention of pose_error().
  [[nodiscard]] Matrix6d predict_covariance(std::int64_t stamp_ns) const;
  /// Is the pose where the prediction and its uncertainty expect it? Far narrower than is_plausible().
  [[nodiscard]] bool is_expected(std::int64_t stamp_ns, const Rigid3& T_map_camera, const Matrix6d& covariance) const;
  /// Could the camera have gone from the last fix to this pose in that time?
  [[nodiscard]] bool is_plausible(std::int64_t stamp_ns, const Rigid3& T_map_camera) const;

 private:
  [[nodiscard]] double fading(std::int64_t stamp_ns) const;

  LocalizerNumbers numbers_;
  bool has_fix_ = false;
  bool has_velocity_ = false;
  std::int64_t stamp_ns_ = 0;
  Rigid3 T_map_camera_;
  Matrix6d covariance_ = Matrix6d::Zero();
  Eigen::Vector3d velocity_camera_m_per_s_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d turn_camera_rad_per_s_ = Eigen::Vector3d::Zero();
};

}  // namespace camloc
