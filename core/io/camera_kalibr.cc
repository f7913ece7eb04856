// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// kalibr's camchain (github.com/ethz-asl/kalibr/wiki/yaml-formats): cam0 ... camN, each with T_cn_cnm1, which takes points of the camera
// before it to its own frame. Topics tell colour from infrared; where they do not, the first camera is colour, and the others are left out
// by name.
#include <algorithm>
#include <optional>

#include "core/io/calibration_nodes.h"

namespace camloc {

namespace {

struct ChainCamera {
  std::string title;  ///< "cam1 (/rgbd/ir/image_raw)"
  Intrinsics intrinsics;
  Rigid3 T_camera_cam0;
  bool is_color = false, is_depth = false;  ///< by its topic
};

Intrinsics read_intrinsics(const YAML::Node& cam) {
  if (scalar_or(cam, "camera_model", "pinhole") != "pinhole") fail(cam["camera_model"], "camera_model: only pinhole is read");
  const YAML::Node intrinsics_node = need(cam, "intrinsics"), resolution_node = need(cam, "resolution");
  const std::vector<double> intrinsics = numbers(intrinsics_node, "intrinsics");
  if (intrinsics.size() != 4) fail(intrinsics_node, "intrinsics: expected fx fy cx cy");
  if (!resolution_node.IsSequence() || resolution_node.size() != 2) fail(resolution_node, "resolution: expected width and height");
  Intrinsics k;
  k.fx = intrinsics[0], k.fy = intrinsics[1], k.cx = intrinsics[2], k.cy = intrinsics[3];
  k.width = pixels(resolution_node[0], "resolution");
  k.height = pixels(resolution_node[1], "resolution");
  const YAML::Node coefficients = cam["distortion_coeffs"];
  const LensModel lens = lens_of(cam, scalar_or(cam, "distortion_model", "none"));
  set_distortion(cam, lens, coefficients.IsDefined() ? numbers(coefficients, "distortion_coeffs") : std::vector<double>{}, &k);
  return k;
}

Rigid3 read_transform(const YAML::Node& node) {
  if (!node.IsSequence() || node.size() != 4) fail(node, "T_cn_cnm1: expected a 4x4 matrix");
  Eigen::Matrix4d m;
  for (std::size_t row = 0; row < 4; ++row) {
    const std::vector<double> values = numbers(node[row], "T_cn_cnm1");
    if (values.size() != 4) fail(node, "T_cn_cnm1: expected a 4x4 matrix");
    for (std::size_t column = 0; column < 4; ++column)
      m(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column)) = values[column];
  }
  const Eigen::Matrix3d rotation = m.topLeftCorner<3, 3>();
  if (!((rotation.transpose() * rotation - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < 0.02 && rotation.determinant() > 0)) {
    fail(node, "T_cn_cnm1: not a rotation and a translation");
  }
  return {nearest_rotation(rotation), m.topRightCorner<3, 1>()};
}

bool has_word(const std::string& topic, std::initializer_list<const char*> words) {
  return std::any_of(words.begin(), words.end(), [&](const char* word) { return topic.find(word) != std::string::npos; });
}

std::vector<ChainCamera> read_chain(const YAML::Node& root) {
  std::vector<ChainCamera> chain;
  for (int i = 0; root["cam" + std::to_string(i)].IsDefined(); ++i) {
    const std::string key = "cam" + std::to_string(i);
    const YAML::Node cam = root[key];
    if (!cam.IsMap()) fail(cam, key + ": expected the keys of a kalibr camera");
    const std::string topic = scalar_or(cam, "rostopic", "");
    ChainCamera camera{topic.empty() ? key : key + " (" + topic + ")", read_intrinsics(cam), {}, false, false};
    camera.is_color = has_word(topic, {"rgb/", "color", "colour"});
    camera.is_depth = !camera.is_color && has_word(topic, {"/ir", "infra", "depth"});
    if (i > 0) camera.T_camera_cam0 = read_transform(need(cam, "T_cn_cnm1")) * chain.back().T_camera_cam0;
    chain.push_back(std::move(camera));
  }
  return chain;
}

}  // namespace

void read_kalibr_chain(const YAML::Node& root, const CameraHints& hints, RgbdCamera* camera) {
  const std::vector<ChainCamera> chain = read_chain(root);
  const auto color = std::max(std::find_if(chain.begin(), chain.end(), [](const ChainCamera& c) { return c.is_color; }), chain.begin());
  const auto& chosen = color == chain.end() ? chain.front() : *color;
  const auto depth = std::find_if(chain.begin(), chain.end(), [&](const ChainCamera& c) { return c.is_depth && &c != &chosen; });
  camera->color = chosen.intrinsics;
  hints.note(chosen.title + ": colour" + (chosen.is_color || chain.size() == 1 ? "" : ", as the first; no topic says which is"));
  if (depth != chain.end()) {
    camera->is_depth_registered = false;
    camera->depth = depth->intrinsics;
    camera->T_color_depth = chosen.T_camera_cam0 * depth->T_camera_cam0.inverse();
    hints.note(depth->title + ": infrared, so depth images are taken to be in its pixels; where the driver registers them to colour, " +
               "write registered = true and leave its intrinsics out");
  } else {
    hints.note("depth is taken as registered to colour: no camera of the file is an infrared one");
  }
  for (const ChainCamera& other : chain) {
    if (&other != &chosen && (depth == chain.end() || &other != &*depth)) hints.note(other.title + ": left out");
  }
}

}  // namespace camloc
