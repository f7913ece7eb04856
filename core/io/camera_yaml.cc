// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Calibrations of other tools in YAML, or in what becomes the same nodes: ROS camera_info, OpenCV FileStorage, ORB-SLAM settings, and
// kalibr's chain (camera_kalibr.cc). FileStorage takes lines that are no YAML ("Viewer.PointSize:2", tabs); what strict YAML refuses is
// read once more with those mended.
#include <cctype>
#include <string>
#include <string_view>
#include <vector>

#include "core/io/calibration_nodes.h"

namespace camloc {

namespace {

/// ROS (file or message text) and OpenCV's calibration program.
void read_camera_info(const YAML::Node& root, const CameraHints& hints, RgbdCamera* camera) {
  const YAML::Node matrix_node = first_of(root, {"camera_matrix", "K", "k"});
  const std::vector<double> m = matrix(matrix_node, "camera_matrix");
  if (m.size() != 9 || m[1] != 0 || m[3] != 0 || m[6] != 0 || m[7] != 0 || m[8] != 1)
    fail(matrix_node, "camera_matrix: expected fx 0 cx 0 fy cy 0 0 1");
  Intrinsics* k = &camera->color;
  k->fx = m[0], k->cx = m[2], k->fy = m[4], k->cy = m[5];
  set_size(root, "image_width", find_any(root, {"image_width", "width"}), find_any(root, {"image_height", "height"}), hints, k);
  camera->name = scalar_or(root, "camera_name", "");
  const YAML::Node coefficients = find_any(root, {"distortion_coefficients", "D", "d"});
  const std::string model = scalar_or(root, "fisheye_model", "0") == "1" ? "fisheye" : scalar_or(root, "distortion_model", "plumb_bob");
  if (coefficients.IsDefined()) {
    set_distortion(coefficients, lens_of(root, model), matrix(coefficients, "distortion_coefficients"), k);
  } else {
    hints.note("no distortion coefficients in the file: taken as images that are rectified");
  }
}

/// ORB-SLAM 2 writes "Camera.fx", ORB-SLAM 3 "Camera1.fx".
void read_orb_slam(const YAML::Node& root, const std::string& prefix, const CameraHints& hints, RgbdCamera* camera) {
  const auto value = [&](const std::string& key) { return number(need(root, key.c_str()), key.c_str()); };
  const auto value_or_zero = [&](const std::string& key) { return root[key].IsDefined() ? number(root[key], key.c_str()) : 0.0; };
  Intrinsics* k = &camera->color;
  k->fx = value(prefix + "fx"), k->fy = value(prefix + "fy"), k->cx = value(prefix + "cx"), k->cy = value(prefix + "cy");
  set_size(root, "Camera.width", root["Camera.width"], root["Camera.height"], hints, k);
  const LensModel lens = lens_of(root, scalar_or(root, "Camera.type", "pinhole"));
  const auto names = lens == LensModel::kEquidistant ? std::vector{"k1", "k2", "k3", "k4"} : std::vector{"k1", "k2", "p1", "p2", "k3"};
  std::vector<double> coefficients;
  for (const char* name : names) coefficients.push_back(value_or_zero(prefix + name));
  set_distortion(root, lens, coefficients, k);
  for (const char* key : {"DepthMapFactor", "RGBD.DepthMapFactor"}) {
    if (!root[key].IsDefined()) continue;
    const double factor = number(root[key], key);
    if (!(factor > 0)) fail(root[key], std::string(key) + ": expected units per metre");
    camera->depth_unit_m = 1 / factor;
  }
}

/// OpenCV's "%YAML:1.0" is no YAML directive; the line is blanked so that line numbers stay.
std::string without_directive(std::string text) {
  if (!text.starts_with("%YAML")) return text;
  for (std::size_t i = 0; i < text.size() && text[i] != '\n'; ++i) text[i] = ' ';
  return text;
}

/// A blank after the colon of every "key:value", blanks for tabs. Lines stay lines.
std::string mended(const std::string& text) {
  std::string result;
  bool is_key = true;  // since the begin of the line nothing but a name
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    result += c == '\t' ? ' ' : c;
    if (c == ':' && is_key && i + 1 < text.size() && text[i + 1] != ' ' && text[i + 1] != '\n' && text[i + 1] != '\r') result += ' ';
    is_key = c == '\n' ||
             (is_key && (std::isalnum(static_cast<unsigned char>(c)) != 0 || std::string_view("._- \t").find(c) != std::string_view::npos));
  }
  return result;
}

YAML::Node load(const std::string& text) {
  const std::string plain = without_directive(text);
  try {
    return YAML::Load(plain);
  } catch (const YAML::Exception&) {
    const std::string again = mended(plain);
    if (again == plain) throw;
    return YAML::Load(again);
  }
}

}  // namespace

void read_calibration(const YAML::Node& root, const CameraHints& hints, RgbdCamera* camera) {
  if (!root.IsMap()) fail(root, "no calibration of kalibr, ROS, OpenCV or ORB-SLAM");
  if (root["cam0"].IsDefined()) return read_kalibr_chain(root, hints, camera);
  hints.note("depth is taken as registered to colour: the file has one camera");
  for (const char* prefix : {"Camera1.", "Camera."}) {
    if (root[std::string(prefix) + "fx"].IsDefined()) return read_orb_slam(root, prefix, hints, camera);
  }
  for (const char* key : {"camera_matrix", "K", "k"}) {
    if (root[key].IsDefined()) return read_camera_info(root, hints, camera);
  }
  fail(root, "no calibration of kalibr (cam0), ROS or OpenCV (camera_matrix) or ORB-SLAM (Camera.fx)");
}

Result<RgbdCamera> parse_camera_yaml(const std::string& text, const std::string& name, const CameraHints& hints) {
  return parse_foreign(name, [&](RgbdCamera* camera) { read_calibration(load(text), hints, camera); });
}

}  // namespace camloc
