// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Camera calibration files: our TOML, and the YAML of kalibr (camchain), ROS (camera_info) and OpenCV / ORB-SLAM. The
// kind is told from the content, not from the file's name. Examples of the TOML are in config/cameras.
//
// The YAML kinds describe the colour camera only: depth is taken as registered, 1 mm a unit unless DepthMapFactor says
// otherwise. Of a camchain cam0 is read.
#pragma once

#include <string>

#include "core/base/result.h"
#include "core/geometry/camera.h"

namespace camloc {

/// Errors name file and line or key. Unknown keys in our own TOML are errors. The camera passed RgbdCamera::validate().
[[nodiscard]] Result<RgbdCamera> read_camera_file(const std::string& path);
/// The same from memory; `name` is for messages, and names the camera where the text does not.
[[nodiscard]] Result<RgbdCamera> parse_camera(const std::string& text, const std::string& name);
/// Our TOML, readable by read_camera_file to the last bit.
[[nodiscard]] std::string format_camera_toml(const RgbdCamera& camera);

/// The two parsers behind parse_camera(). Neither lets an exception out; neither checks more than that the keys are there and have the
/// right type.
[[nodiscard]] Result<RgbdCamera> parse_camera_toml(const std::string& text, const std::string& name);
[[nodiscard]] Result<RgbdCamera> parse_camera_yaml(const std::string& text, const std::string& name);

}  // namespace camloc
