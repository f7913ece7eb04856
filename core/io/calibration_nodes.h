// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What the readers of foreign calibrations share: YAML nodes (JSON is YAML, and FileStorage's XML becomes nodes) with numbers checked.
// For core/io alone: BadCalibration is caught by parse_foreign().
#pragma once

#include <yaml-cpp/yaml.h>

#include <functional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/geometry/camera.h"
#include "core/io/camera_file.h"

namespace camloc {

/// Thrown by the readers, as yaml-cpp's own exceptions are.
struct BadCalibration {
  int line = 0;  ///< from 1; 0: the file as a whole
  std::string what;
};

/// Runs `read` and makes an error of whatever it throws, naming file and line.
[[nodiscard]] Result<RgbdCamera> parse_foreign(const std::string& name, const std::function<void(RgbdCamera*)>& read);

[[noreturn]] void fail(const YAML::Node& node, const std::string& what);
[[nodiscard]] YAML::Node need(const YAML::Node& parent, const char* key);
/// The first of `keys` that is there.
[[nodiscard]] YAML::Node first_of(const YAML::Node& parent, std::initializer_list<const char*> keys);
[[nodiscard]] YAML::Node find_any(const YAML::Node& parent, std::initializer_list<const char*> keys);
[[nodiscard]] double number(const YAML::Node& node, const char* key);
[[nodiscard]] int pixels(const YAML::Node& node, const char* key);
/// A short list.
[[nodiscard]] std::vector<double> numbers(const YAML::Node& node, const char* key);
/// A plain list, or OpenCV's and ROS's {rows, cols, data}.
[[nodiscard]] std::vector<double> matrix(const YAML::Node& node, const char* key);
[[nodiscard]] std::string scalar_or(const YAML::Node& parent, const char* key, const std::string& fallback);
/// The size that the file says at these nodes, of which `key` names the first; else the hint's, with a note; else an error that says what
/// to do.
void set_size(const YAML::Node& parent, const char* key, const YAML::Node& width, const YAML::Node& height, const CameraHints& hints,
              Intrinsics* k);
void set_distortion(const YAML::Node& node, LensModel lens, const std::vector<double>& values, Intrinsics* k);
[[nodiscard]] LensModel lens_of(const YAML::Node& node, const std::string& name);

/// kalibr, ROS, OpenCV and ORB-SLAM: whatever `root` is.
void read_calibration(const YAML::Node& root, const CameraHints& hints, RgbdCamera* camera);
/// cam0 ... camN of kalibr: colour, and the infrared camera that depth comes from.
void read_kalibr_chain(const YAML::Node& root, const CameraHints& hints, RgbdCamera* camera);

}  // namespace camloc
