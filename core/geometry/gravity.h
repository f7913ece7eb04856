// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Which way is up in a map: from an accelerometer that was carried with the camera, or from the floor the camera saw.
// Offline; allocates.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/base/result.h"
#include "core/geometry/rigid3.h"

namespace camloc {

inline constexpr double kStandardGravity = 9.80665;  ///< m/s^2

enum class GravitySource : std::uint8_t { kAccelerometer, kFloor };

struct GravityEstimate {
  Eigen::Vector3d up_map = Eigen::Vector3d::UnitZ();  ///< unit vector, axes of `map`
  double sigma_rad = 0;                               ///< standard deviation of its tilt about each horizontal axis
  GravitySource source = GravitySource::kFloor;
  double inlier_share = 0;     ///< of the readings, or of the points below the cameras, that agree
  double camera_height_m = 0;  ///< kFloor: median height of the cameras above it
};

/// Mean direction to which the tops of images point (-y of the cameras): good to some 20 degrees where people carry the
/// camera. nullopt where the cameras are in all orientations.
[[nodiscard]] std::optional<Eigen::Vector3d> rough_up(std::span<const Rigid3> T_map_camera);

// ---- accelerometer

/// One reading with the orientation of the camera at its time.
struct OrientedReading {
  Eigen::Quaterniond R_map_camera = Eigen::Quaterniond::Identity();
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  ///< m/s^2, axes of the accelerometer; at rest it points up
};

/// From the axes of the accelerometer to those of the camera. The default is the Kinect's: y up, z along the view, x to the left
/// of it, so that a level Kinect at rest reads (0, +9.8, 0).
[[nodiscard]] Eigen::Matrix3d kinect_R_camera_accelerometer();

/// Robust mean of R_map_camera R_camera_accelerometer a: half of the readings may be anything.
/// Errors: kInvalid (too few readings at rest; they disagree) with what to look at.
[[nodiscard]] Result<GravityEstimate> gravity_from_accelerometer(std::span<const OrientedReading> readings);

// ---- floor

/// The lowest plane with much support below the cameras, refined by least squares. Seeded: the same points give the same
/// bits. `points_map` are dense surface points; landmarks do when there are many on the floor.
/// Errors: kInvalid (no camera, no point below them), kNotFound (no clear floor, and why).
[[nodiscard]] Result<GravityEstimate> gravity_from_floor(std::span<const Eigen::Vector3d> points_map,
                                                         std::span<const Eigen::Vector3d> camera_centers_map,
                                                         const Eigen::Vector3d& rough_up_map);

}  // namespace camloc
