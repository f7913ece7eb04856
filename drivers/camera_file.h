// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Camera calibration files: our TOML, and the YAML of kalibr (camchain), ROS (camera_info) and OpenCV / ORB-SLAM.
#pragma once

#include <string>

#include "core/base/result.h"
#include "core/geometry/camera.h"

namespace camloc {

/// Errors name file and line or key. Unknown keys in our own TOML are errors.
[[nodiscard]] Result<RgbdCamera> read_camera_file(const std::string& path);
/// Our TOML, readable by read_camera_file to the last bit.
[[nodiscard]] std::string format_camera_toml(const RgbdCamera& camera);

}  // namespace camloc
