// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Camera calibration files: our TOML; YAML of kalibr (camchain), ROS (camera_info), OpenCV and ORB-SLAM; XML of OpenCV; JSON of Open3D and
// of the SDKs of RealSense and Kinect; cameras.txt of COLMAP. The kind is told from the content, not from the file's name, by the table of
// camera_file.cc. Examples of the TOML are in config/cameras.
//
// Where a file describes the colour camera only, depth is taken as registered, 1 mm a unit unless the file says otherwise. What became of
// each camera of the file, and what was assumed, is in CameraHints::notes.
#pragma once

#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/geometry/camera.h"

namespace camloc {

/// What the caller knows that a file may not say, and what a reader has to tell.
struct CameraHints {
  int width = 0, height = 0;                  ///< of the images, for files without it; 0: not known
  std::vector<std::string>* notes = nullptr;  ///< a line each
  void note(const std::string& text) const {
    if (notes != nullptr) notes->push_back(text);
  }
};

/// Errors name file and line or key. Unknown keys in our own TOML are errors. The camera passed RgbdCamera::validate().
[[nodiscard]] Result<RgbdCamera> read_camera_file(const std::string& path, const CameraHints& hints = {});
/// The same from memory; `name` is for messages, and names the camera where the text does not.
[[nodiscard]] Result<RgbdCamera> parse_camera(const std::string& text, const std::string& name, const CameraHints& hints = {});
/// Our TOML, readable by read_camera_file to the last bit. `comments` come first, a line each.
[[nodiscard]] std::string format_camera_toml(const RgbdCamera& camera, const std::vector<std::string>& comments = {});

/// The parsers behind parse_camera(). None lets an exception out; none checks more than that the keys are there and have the right type.
[[nodiscard]] Result<RgbdCamera> parse_camera_toml(const std::string& text, const std::string& name);
[[nodiscard]] Result<RgbdCamera> parse_camera_yaml(const std::string& text, const std::string& name, const CameraHints& hints = {});
[[nodiscard]] Result<RgbdCamera> parse_camera_xml(const std::string& text, const std::string& name, const CameraHints& hints = {});
[[nodiscard]] Result<RgbdCamera> parse_camera_json(const std::string& text, const std::string& name, const CameraHints& hints = {});
[[nodiscard]] Result<RgbdCamera> parse_camera_colmap(const std::string& text, const std::string& name, const CameraHints& hints = {});
/// True where a text is COLMAP's cameras.txt.
[[nodiscard]] bool is_colmap_cameras(const std::string& text);
/// A camera of COLMAP by its model's name and parameters. kUnsupported: the model, with those that are read; kInvalid: another number of
/// parameters than it has.
[[nodiscard]] Result<Intrinsics> colmap_intrinsics(const std::string& model_name, int width, int height,
                                                   const std::vector<double>& parameters);

}  // namespace camloc
