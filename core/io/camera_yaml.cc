// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Calibrations of other tools: kalibr camchain, ROS camera_info, OpenCV FileStorage, ORB-SLAM settings. yaml-cpp throws;
// nothing it throws leaves parse_camera_yaml.
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/io/camera_file.h"
#include "core/io/text.h"

namespace camloc {

namespace {

/// Thrown in this file only, and caught at its border like yaml-cpp's own.
struct BadCalibration {
  int line = 0;  ///< from 1; 0: the file as a whole
  std::string what;
};

[[noreturn]] void fail(const YAML::Node& node, const std::string& what) {
  throw BadCalibration{node.IsDefined() ? node.Mark().line + 1 : 0, what};
}

YAML::Node need(const YAML::Node& parent, const char* key) {
  YAML::Node node = parent[key];
  if (!node.IsDefined()) fail(parent, std::string("needs ") + key);
  return node;
}

double number(const YAML::Node& node, const char* key) {
  const std::optional<double> value = node.IsScalar() ? parse_double(node.Scalar()) : std::nullopt;
  if (!value || !std::isfinite(*value)) fail(node, std::string(key) + ": expected a number");
  return *value;
}

int pixels(const YAML::Node& node, const char* key) {
  const double value = number(node, key);
  if (value < 1 || value > 16384 || value != std::floor(value)) fail(node, std::string(key) + ": expected 1 to 16384 pixels");
  return static_cast<int>(value);
}

std::vector<double> numbers(const YAML::Node& node, const char* key) {
  if (!node.IsSequence() || node.size() > 16) fail(node, std::string(key) + ": expected a short list of numbers");
  std::vector<double> values;
  for (std::size_t i = 0; i < node.size(); ++i) values.push_back(number(node[i], key));
  return values;
}

/// A plain list, or OpenCV's and ROS's {rows, cols, data}.
std::vector<double> matrix(const YAML::Node& node, const char* key) { return numbers(node.IsMap() ? need(node, "data") : node, key); }

void set_distortion(const YAML::Node& node, LensModel lens, const std::vector<double>& values, Intrinsics* k) {
  const std::size_t most = lens == LensModel::kEquidistant ? 4 : 5;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i < most) k->distortion[i] = values[i];
    if (i >= most && values[i] != 0)
      fail(node, "distortion: " + std::to_string(values.size()) + " coefficients; at most " + std::to_string(most) + " are read");
  }
  const bool has_any = std::any_of(k->distortion.begin(), k->distortion.end(), [](double value) { return value != 0; });
  // Equidistant without coefficients is still not a pinhole.
  k->lens = has_any || lens == LensModel::kEquidistant ? lens : LensModel::kPinhole;
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : static_cast<char>(c); });
  return text;
}

LensModel lens_of(const YAML::Node& node, const std::string& name) {
  const std::string model = lower(name);
  constexpr std::array kPlain = {"radtan", "plumb_bob", "rational_polynomial", "none", "pinhole", ""};
  constexpr std::array kWide = {"equidistant", "fisheye", "kannalabrandt8"};
  if (std::find(kPlain.begin(), kPlain.end(), model) != kPlain.end()) return LensModel::kBrownConrady;
  if (std::find(kWide.begin(), kWide.end(), model) != kWide.end()) return LensModel::kEquidistant;
  fail(node, "lens model " + in_quotes(name) + " is not known");
}

std::string scalar_or(const YAML::Node& parent, const char* key, const std::string& fallback) {
  const YAML::Node node = parent[key];
  return node.IsDefined() && node.IsScalar() ? node.Scalar() : fallback;
}

void read_kalibr(const YAML::Node& cam, RgbdCamera* camera) {
  if (scalar_or(cam, "camera_model", "pinhole") != "pinhole") fail(cam["camera_model"], "camera_model: only pinhole is read");
  const YAML::Node intrinsics_node = need(cam, "intrinsics"), resolution_node = need(cam, "resolution");
  const std::vector<double> intrinsics = numbers(intrinsics_node, "intrinsics");
  if (intrinsics.size() != 4) fail(intrinsics_node, "intrinsics: expected fx fy cx cy");
  if (!resolution_node.IsSequence() || resolution_node.size() != 2) fail(resolution_node, "resolution: expected width and height");
  Intrinsics* k = &camera->color;
  k->fx = intrinsics[0], k->fy = intrinsics[1], k->cx = intrinsics[2], k->cy = intrinsics[3];
  k->width = pixels(resolution_node[0], "resolution");
  k->height = pixels(resolution_node[1], "resolution");
  const YAML::Node coefficients = cam["distortion_coeffs"];
  const LensModel lens = lens_of(cam, scalar_or(cam, "distortion_model", "none"));
  set_distortion(cam, lens, coefficients.IsDefined() ? numbers(coefficients, "distortion_coeffs") : std::vector<double>{}, k);
}

YAML::Node first_of(const YAML::Node& parent, std::initializer_list<const char*> keys) {
  for (const char* key : keys) {
    YAML::Node node = parent[key];
    if (node.IsDefined()) return node;
  }
  fail(parent, std::string("needs ") + *keys.begin());
}

/// ROS (file or message text) and OpenCV's calibration program.
void read_camera_info(const YAML::Node& root, RgbdCamera* camera) {
  const YAML::Node matrix_node = first_of(root, {"camera_matrix", "K", "k"});
  const std::vector<double> m = matrix(matrix_node, "camera_matrix");
  if (m.size() != 9 || m[1] != 0 || m[3] != 0 || m[6] != 0 || m[7] != 0 || m[8] != 1)
    fail(matrix_node, "camera_matrix: expected fx 0 cx 0 fy cy 0 0 1");
  Intrinsics* k = &camera->color;
  k->fx = m[0], k->cx = m[2], k->fy = m[4], k->cy = m[5];
  k->width = pixels(first_of(root, {"image_width", "width"}), "image_width");
  k->height = pixels(first_of(root, {"image_height", "height"}), "image_height");
  camera->name = scalar_or(root, "camera_name", "");
  const YAML::Node coefficients = first_of(root, {"distortion_coefficients", "D", "d"});
  const std::string model = scalar_or(root, "fisheye_model", "0") == "1" ? "fisheye" : scalar_or(root, "distortion_model", "plumb_bob");
  set_distortion(coefficients, lens_of(root, model), matrix(coefficients, "distortion_coefficients"), k);
}

/// ORB-SLAM 2 writes "Camera.fx", ORB-SLAM 3 "Camera1.fx".
void read_orb_slam(const YAML::Node& root, const std::string& prefix, RgbdCamera* camera) {
  const auto value = [&](const std::string& key) { return number(need(root, key.c_str()), key.c_str()); };
  const auto value_or_zero = [&](const std::string& key) { return root[key].IsDefined() ? number(root[key], key.c_str()) : 0.0; };
  Intrinsics* k = &camera->color;
  k->fx = value(prefix + "fx"), k->fy = value(prefix + "fy"), k->cx = value(prefix + "cx"), k->cy = value(prefix + "cy");
  k->width = pixels(need(root, "Camera.width"), "Camera.width");
  k->height = pixels(need(root, "Camera.height"), "Camera.height");
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

void read_any(const YAML::Node& root, RgbdCamera* camera) {
  if (!root.IsMap()) fail(root, "no calibration of kalibr, ROS, OpenCV or ORB-SLAM");
  if (root["cam0"].IsDefined()) {
    if (!root["cam0"].IsMap()) fail(root["cam0"], "cam0: expected the keys of a kalibr camera");
    return read_kalibr(root["cam0"], camera);
  }
  for (const char* prefix : {"Camera1.", "Camera."}) {
    if (root[std::string(prefix) + "fx"].IsDefined()) return read_orb_slam(root, prefix, camera);
  }
  for (const char* key : {"camera_matrix", "K", "k"}) {
    if (root[key].IsDefined()) return read_camera_info(root, camera);
  }
  fail(root, "no calibration of kalibr (cam0), ROS or OpenCV (camera_matrix) or ORB-SLAM (Camera.fx)");
}

/// OpenCV's "%YAML:1.0" is no YAML directive; the line is blanked so that line numbers stay.
std::string without_directive(std::string text) {
  if (!text.starts_with("%YAML")) return text;
  for (std::size_t i = 0; i < text.size() && text[i] != '\n'; ++i) text[i] = ' ';
  return text;
}

}  // namespace

Result<RgbdCamera> parse_camera_yaml(const std::string& text, const std::string& name) {
  try {
    RgbdCamera camera;
    read_any(YAML::Load(without_directive(text)), &camera);
    camera.depth = camera.color;
    return camera;
  } catch (const BadCalibration& bad) {
    return bad.line > 0 ? line_error(name, bad.line, bad.what) : Status(ErrorCode::kInvalid, name + ": " + bad.what);
  } catch (const YAML::Exception& error) {
    return line_error(name, std::max(error.mark.line + 1, 1), error.msg);
  } catch (const std::exception& error) { return Status(ErrorCode::kInvalid, name + ": " + error.what()); }
}

}  // namespace camloc
