// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// How a person carries the camera along a path: smoothed, slower in bends, head bobbing, looking around.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/geometry/rigid3.h"

namespace camloc::sim {

struct WalkStyle {
  std::uint32_t seed = 1;
  double height_m = 1.62;        ///< mean height of the camera over the floor
  double speed_m_s = 0.9;        ///< on straight stretches
  double turn_rate_rad_s = 0.8;  ///< slows down in bends to stay below
  double pitch_rad = -0.12;      ///< mean, negative looks down
  double look_rad = 0.35;        ///< amplitude of looking left and right
};

/// Camera pose over time, seconds from its start.
class Trajectory {
 public:
  /// Walks along straight lines between `path` points (metres on the floor), corners rounded.
  Trajectory(const std::vector<Eigen::Vector2d>& path, const WalkStyle& style);

  [[nodiscard]] double duration_s() const;
  /// T_world_camera, camera optical: x right, y down, z forward. Clamped to the start and end.
  [[nodiscard]] Rigid3 pose(double time_s) const;
  /// Velocity (m/s) and angular velocity (rad/s) of the camera, both in its own axes.
  struct Twist {
    Eigen::Vector3d linear, angular;
  };
  [[nodiscard]] Twist twist(double time_s) const;

 private:
  /// Position, yaw, pitch, roll.
  using Sample = Eigen::Matrix<double, 6, 1>;
  std::vector<Sample> samples_;  ///< every kStep seconds
};

}  // namespace camloc::sim
