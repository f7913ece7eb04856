// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Accelerometer files beside a recording: TUM RGB-D's accelerometer.txt, "timestamp ax ay az" in seconds and m/s^2 (or g).
// The TUM benchmark does not say which way the axes point; see kinect_R_camera_accelerometer() in
// core/geometry/gravity.h.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/geometry/gravity.h"
#include "core/io/sequence.h"

namespace camloc {

struct AccelerometerSample {
  std::int64_t stamp_ns = 0;
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  ///< m/s^2, axes of the sensor; at rest it points up
};

/// Readings of length about 1 are taken as multiples of standard gravity. Stamps ascend. Errors name file and line; kInvalid
/// also where the typical length is neither that of m/s^2 nor of g.
[[nodiscard]] Result<std::vector<AccelerometerSample>> read_accelerometer(const std::string& path);

/// The readings at whose time the camera has a pose (pose_at of sequence.h), with its orientation.
[[nodiscard]] std::vector<OrientedReading> with_orientations(const std::vector<AccelerometerSample>& samples,
                                                             const std::vector<StampedPose>& trajectory);

}  // namespace camloc
