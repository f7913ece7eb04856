// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Intrinsics in JSON, as programs around cameras write them: Open3D (intrinsic_matrix, column by column), and the fields of the RealSense
// and Kinect SDKs (fx fy ppx ppy or cx cy, coeffs or k1 k2 p1 p2 k3 k4 k5 k6), of colour alone or of colour and depth. JSON is YAML.
#include <algorithm>
#include <string>
#include <vector>

#include "core/io/calibration_nodes.h"

namespace camloc {

namespace {

YAML::Node any_of_keys(const YAML::Node& parent, std::initializer_list<const char*> keys) {
  return parent.IsMap() ? find_any(parent, keys) : YAML::Node(YAML::NodeType::Undefined);
}

/// Open3D stores Eigen's matrix as it lies in memory; by rows is taken, too, where that alone makes sense.
void read_matrix(const YAML::Node& node, Intrinsics* k) {
  std::vector<double> m;
  if (node.IsSequence() && node.size() == 3 && node[0].IsSequence()) {
    for (std::size_t row = 0; row < 3; ++row) {
      for (const double value : numbers(node[row], "intrinsic_matrix")) m.push_back(value);
    }
  } else {
    m = numbers(node, "intrinsic_matrix");
    if (m.size() == 9 && m[2] == 0 && m[5] == 0) std::swap(m[1], m[3]), std::swap(m[2], m[6]), std::swap(m[5], m[7]);
  }
  if (m.size() != 9 || m[1] != 0 || m[3] != 0 || m[6] != 0 || m[7] != 0 || m[8] != 1)
    fail(node, "intrinsic_matrix: expected fx 0 cx, 0 fy cy, 0 0 1");
  k->fx = m[0], k->cx = m[2], k->fy = m[4], k->cy = m[5];
}

std::vector<double> coefficients_of(const YAML::Node& node) {
  const YAML::Node list = any_of_keys(node, {"coeffs", "coefficients", "distortion", "distortion_coefficients", "D", "disto"});
  if (list.IsDefined() && list.IsSequence()) return numbers(list, "coeffs");
  const YAML::Node named = list.IsDefined() && list.IsMap() ? list : node;
  std::vector<double> values;
  for (const char* key : {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"}) {
    values.push_back(named[key].IsDefined() ? number(named[key], key) : 0);
  }
  while (!values.empty() && values.back() == 0) values.pop_back();
  return values;
}

/// What the SDKs call the lens. RealSense's inverse model maps the other way round.
LensModel lens_named(const YAML::Node& node, const std::vector<double>& coefficients) {
  const YAML::Node model = any_of_keys(node, {"model", "distortion_model", "distortion"});
  std::string name = model.IsDefined() && model.IsScalar() ? model.Scalar() : "";
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : static_cast<char>(c); });
  const bool has_any = std::any_of(coefficients.begin(), coefficients.end(), [](double value) { return value != 0; });
  if (name.find("inverse") != std::string::npos && has_any) {
    fail(
        model,
        "the lens model is RealSense's inverse Brown-Conrady with coefficients that are not 0, which is not read; calibrate the camera, or "
        "record rectified images");
  }
  if (name.find("theta") != std::string::npos && has_any) fail(model, "the lens model F-Theta is not read");
  const bool is_wide = name.find("kannala") != std::string::npos || name.find("fisheye") != std::string::npos || name == "equidistant";
  return is_wide ? LensModel::kEquidistant : LensModel::kBrownConrady;
}

void read_intrinsics(const YAML::Node& node, const CameraHints& hints, Intrinsics* k) {
  if (!node.IsMap()) fail(node, "expected intrinsics: width, height, fx, fy, ...");
  set_size(node, "width", any_of_keys(node, {"width", "image_width", "w"}), any_of_keys(node, {"height", "image_height", "h"}), hints, k);
  if (const YAML::Node m = any_of_keys(node, {"intrinsic_matrix", "camera_matrix", "K"}); m.IsDefined()) {
    read_matrix(m.IsMap() ? need(m, "data") : m, k);
  } else {
    k->fx = number(need(node, "fx"), "fx"), k->fy = number(need(node, "fy"), "fy");
    k->cx = number(first_of(node, {"cx", "ppx"}), "cx"), k->cy = number(first_of(node, {"cy", "ppy"}), "cy");
  }
  const std::vector<double> coefficients = coefficients_of(node);
  set_distortion(node, lens_named(node, coefficients), coefficients, k);
}

bool has_intrinsics(const YAML::Node& node) { return any_of_keys(node, {"intrinsic_matrix", "camera_matrix", "K", "fx"}).IsDefined(); }

/// The intrinsics of a stream, which some programs put one level deeper.
YAML::Node stream_of(const YAML::Node& root, std::initializer_list<const char*> keys) {
  const YAML::Node node = any_of_keys(root, keys);
  if (!node.IsDefined() || has_intrinsics(node)) return node;
  return any_of_keys(node, {"intrinsics", "intrinsic", "parameters"});
}

/// rs2_extrinsics: rotation column by column, metres.
Rigid3 read_extrinsics(const YAML::Node& node) {
  const std::vector<double> r = numbers(need(node, "rotation"), "rotation"), t = numbers(need(node, "translation"), "translation");
  if (r.size() != 9 || t.size() != 3) fail(node, "expected a rotation of 9 numbers and a translation of 3, metres");
  Eigen::Matrix3d rotation;
  rotation << r[0], r[3], r[6], r[1], r[4], r[7], r[2], r[5], r[8];
  if (!((rotation.transpose() * rotation - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < 0.02))
    fail(node, "rotation: not a rotation");
  return {nearest_rotation(rotation), {t[0], t[1], t[2]}};
}

void read_depth(const YAML::Node& root, const CameraHints& hints, RgbdCamera* camera) {
  const YAML::Node depth = stream_of(root, {"depth", "depth_intrinsics", "Depth"});
  const YAML::Node extrinsics = any_of_keys(root, {"depth_to_color", "depth_to_colour", "T_color_depth", "extrinsics"});
  if (const YAML::Node scale = any_of_keys(root, {"depth_scale", "depth_units"}); scale.IsDefined()) {
    const double value = number(scale, "depth_scale");
    if (!(value > 0)) fail(scale, "depth_scale: expected metres a unit, or units a metre");
    camera->depth_unit_m = value >= 1 ? 1 / value : value;  // Open3D writes 1000, RealSense 0.001
    hints.note("depth unit " + std::to_string(camera->depth_unit_m) + " m, from depth_scale");
  }
  if (!depth.IsDefined() || !extrinsics.IsDefined() || !extrinsics.IsMap()) {
    hints.note(
        depth.IsDefined()
            ? "depth: left out, the file does not say where the depth camera is (depth_to_color); depth is taken as registered to colour"
            : "depth is taken as registered to colour: the file has one camera");
    return;
  }
  camera->is_depth_registered = false;
  read_intrinsics(depth, hints, &camera->depth);
  camera->T_color_depth = read_extrinsics(extrinsics);
  hints.note("depth: in its own pixels; where your program aligns it to colour, write registered = true and leave its intrinsics out");
}

}  // namespace

Result<RgbdCamera> parse_camera_json(const std::string& text, const std::string& name, const CameraHints& hints) {
  return parse_foreign(name, [&](RgbdCamera* camera) {
    std::string plain = text;
    std::replace(plain.begin(), plain.end(), '\t', ' ');
    const YAML::Node root = YAML::Load(plain);
    if (!root.IsMap()) fail(root, "no calibration in it");
    YAML::Node color = stream_of(root, {"color", "colour", "rgb", "color_intrinsics", "Color", "intrinsic", "intrinsics"});
    if (!color.IsDefined() && has_intrinsics(root)) color = root;
    if (!color.IsDefined()) fail(root, "no intrinsics of a colour camera (color, intrinsic, or fx at the top)");
    read_intrinsics(color, hints, &camera->color);
    read_depth(root, hints, camera);
  });
}

}  // namespace camloc
