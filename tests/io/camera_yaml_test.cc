// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "core/io/camera_file.h"

namespace camloc {
namespace {

RgbdCamera parsed(const std::string& text) {
  const auto camera = parse_camera(text, "dir/cam.yaml");
  EXPECT_TRUE(camera.is_ok()) << camera.status().message();
  return camera ? *camera : RgbdCamera{};
}

const char* const kKalibr = R"(cam0:
  cam_overlaps: []
  camera_model: pinhole
  distortion_coeffs: [0.1, -0.2, 0.001, 0.002]
  distortion_model: radtan
  intrinsics: [461.6, 460.3, 362.7, 248.1]
  resolution: [752, 480]
  rostopic: /camera/color/image_raw
)";

const char* const kRos = R"(image_width: 640
image_height: 480
camera_name: rgb_PS1080
camera_matrix:
  rows: 3
  cols: 3
  data: [525.1, 0, 319.5, 0, 525.2, 239.5, 0, 0, 1]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [0.26, -0.95, -0.005, 0.0026, 1.16]
rectification_matrix: {rows: 3, cols: 3, data: [1, 0, 0, 0, 1, 0, 0, 0, 1]}
)";

const char* const kOrbSlam = R"(%YAML:1.0

#--------------------------------------------
Camera.fx: 517.306408
Camera.fy: 516.469215
Camera.cx: 318.643040
Camera.cy: 255.313989
Camera.k1: 0.262383
Camera.k2: -0.953104
Camera.p1: -0.005358
Camera.p2: 0.002628
Camera.k3: 1.163314
Camera.width: 640
Camera.height: 480
Camera.fps: 30.0
Camera.bf: 40.0
ThDepth: 40.0
DepthMapFactor: 5000.0
)";

TEST(CameraYaml, Kalibr) {
  const RgbdCamera camera = parsed(kKalibr);
  EXPECT_EQ(camera.name, "cam");
  EXPECT_EQ(camera.color.width, 752);
  EXPECT_EQ(camera.color.fy, 460.3);
  EXPECT_EQ(camera.color.lens, LensModel::kBrownConrady);
  EXPECT_EQ(camera.color.distortion, (std::array<double, 8>{0.1, -0.2, 0.001, 0.002, 0}));
  EXPECT_TRUE(camera.is_depth_registered);
  EXPECT_EQ(camera.depth.fy, 460.3);
  EXPECT_EQ(camera.depth_unit_m, 0.001);
}

TEST(CameraYaml, KalibrEquidistant) {
  std::string text = kKalibr;
  text.replace(text.find("radtan"), 6, "equidistant");
  EXPECT_EQ(parsed(text).color.lens, LensModel::kEquidistant);
}

TEST(CameraYaml, RosCameraInfo) {
  const RgbdCamera camera = parsed(kRos);
  EXPECT_EQ(camera.name, "rgb_PS1080");
  EXPECT_EQ(camera.color.fx, 525.1);
  EXPECT_EQ(camera.color.cy, 239.5);
  EXPECT_EQ(camera.color.distortion[4], 1.16);
  const RgbdCamera message =
      parsed("height: 480\nwidth: 640\ndistortion_model: equidistant\nd: [0.1, 0.2, 0.3, 0.4]\nk: [1.5, 0, 320, 0, 1.5, 240, 0, 0, 1]\n");
  EXPECT_EQ(message.color.lens, LensModel::kEquidistant);
  EXPECT_EQ(message.color.width, 640);
}

TEST(CameraYaml, ZeroDistortionIsAPinhole) {
  const RgbdCamera camera = parsed("width: 640\nheight: 480\nD: [0, 0, 0, 0, 0, 0, 0, 0]\nK: [525, 0, 320, 0, 525, 240, 0, 0, 1]\n");
  EXPECT_EQ(camera.color.lens, LensModel::kPinhole);
}

TEST(CameraYaml, OpenCvCalibration) {
  const RgbdCamera camera = parsed(R"(%YAML:1.0
---
image_width: 640
image_height: 480
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 5.2464000000000004e+02, 0., 3.1663e+02, 0., 5.235e+02, 2.5623e+02, 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ 0.1, -0.2, 0., 0., 0. ]
)");
  EXPECT_EQ(camera.color.fx, 524.64);
  EXPECT_EQ(camera.color.distortion[1], -0.2);
}

TEST(CameraYaml, OrbSlamWithDepthFactor) {
  const RgbdCamera camera = parsed(kOrbSlam);
  EXPECT_EQ(camera.color.fx, 517.306408);
  EXPECT_EQ(camera.color.distortion, (std::array<double, 8>{0.262383, -0.953104, -0.005358, 0.002628, 1.163314}));
  EXPECT_DOUBLE_EQ(camera.depth_unit_m, 0.0002);
  std::string three = kOrbSlam;
  for (const char* key : {"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3"})
    three.replace(three.find(std::string("Camera.") + key), 9, std::string("Camera1.") + key);
  three.insert(three.find('\n') + 1, "File.version: \"1.0\"\n");
  EXPECT_EQ(parsed(three).color.distortion, camera.color.distortion);
}

TEST(CameraYaml, SettingsThatFileStorageTakesAndYamlDoesNot) {
  const RgbdCamera camera = parsed(std::string(kOrbSlam) + "\nViewer.PointSize:2\nViewer.Name:\t\"a:b\"\n");
  EXPECT_EQ(camera.color.fx, parsed(kOrbSlam).color.fx);
  EXPECT_EQ(camera.depth_unit_m, 0.0002);
}

TEST(CameraYaml, ASizeThatTheFileDoesNotSayIsAsked) {
  std::string text = kOrbSlam;
  for (const char* key : {"Camera.width: 640\n", "Camera.height: 480\n"}) text.erase(text.find(key), std::string(key).size());
  const auto camera = parse_camera(text, "dir/cam.yaml");
  ASSERT_FALSE(camera.is_ok());
  EXPECT_NE(camera.status().message().find("--size 640x480"), std::string::npos) << camera.status().message();
  std::vector<std::string> notes;
  const auto sized = parse_camera(text, "dir/cam.yaml", {640, 480, &notes});
  ASSERT_TRUE(sized.is_ok()) << sized.status().message();
  EXPECT_EQ(sized->color.height, 480);
  EXPECT_EQ(notes.size(), 2U);
}

TEST(CameraYaml, WithoutCoefficientsTheImagesAreRectified) {
  std::vector<std::string> notes;
  const auto camera = parse_camera(
      "%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
      "   data: [ 525., 0., 319.5, 0., 525., 239.5, 0., 0., 1. ]\n",
      "dir/cam.yaml", {0, 0, &notes});
  ASSERT_TRUE(camera.is_ok()) << camera.status().message();
  EXPECT_EQ(camera->color.lens, LensModel::kPinhole);
  EXPECT_EQ(camera->color.cx, 319.5);
  ASSERT_EQ(notes.size(), 2U);
  EXPECT_NE(notes[1].find("rectified"), std::string::npos);
}

TEST(CameraYaml, RationalLensIsKeptWithoutLoss) {
  const RgbdCamera camera = parsed(
      "header:\n  stamp: {sec: 0, nanosec: 0}\n  frame_id: rgb_camera_link\nheight: 720\nwidth: 1280\ndistortion_model: "
      "rational_polynomial\n"
      "d: [0.52, -2.71, 0.0006, -0.0001, 1.58, 0.40, -2.54, 1.51]\nk: [607.1, 0.0, 638.2, 0.0, 606.9, 366.4, 0.0, 0.0, 1.0]\n");
  EXPECT_EQ(camera.color.lens, LensModel::kRational);
  EXPECT_EQ(camera.color.distortion, (std::array<double, 8>{0.52, -2.71, 0.0006, -0.0001, 1.58, 0.40, -2.54, 1.51}));
  const auto again = parse_camera(format_camera_toml(camera), "again");
  ASSERT_TRUE(again.is_ok()) << again.status().message();
  EXPECT_EQ(again->color.lens, LensModel::kRational);
  EXPECT_EQ(again->color.distortion, camera.color.distortion);
  const Eigen::Vector2d ray = again->color.undistort({1200, 100});
  EXPECT_NEAR(ray.x(), 0.8788, 1e-3);
  EXPECT_NEAR(ray.y(), -0.4173, 1e-3);
}

TEST(CameraYaml, ErrorsNameFileAndLineOrKey) {
  const auto changed = [](std::string text, const std::string& from, const std::string& to) {
    return text.replace(text.find(from), from.size(), to);
  };
  const struct {
    std::string text;
    const char* part;
  } cases[] = {
      {changed(kKalibr, "[752, 480]", "[752]"), "cam.yaml:7: resolution"},
      {changed(kKalibr, "  resolution: [752, 480]\n", ""), "needs resolution"},
      {changed(kKalibr, "radtan", "fov"), "lens model 'fov'"},
      {changed(kKalibr, "model: pinhole", "model: omni"), "cam.yaml:3: camera_model"},
      {changed(kKalibr, "461.6", "x"), "cam.yaml:6: intrinsics: expected a number"},
      {changed(kKalibr, "461.6", ".nan"), "intrinsics"},
      {changed(kKalibr, "461.6", "-1"), "cam.yaml"},
      {changed(kRos, "525.1, 0, 319.5", "525.1, 3, 319.5"), "cam.yaml:5: camera_matrix"},
      {changed(kRos, "image_width: 640\n", ""), "needs image_width"},
      {changed(kRos, "image_width: 640", "image_width: 640.5"), "cam.yaml:1: image_width"},
      {changed(kRos, "1.16]", "1.16, 0.1]"), "6 coefficients"},
      {changed(kOrbSlam, "Camera.cy", "Camera.cz"), "needs Camera.cy"},
      {changed(kOrbSlam, "Camera.width: 640", "w: 1"), "needs Camera.width"},
      {changed(kOrbSlam, "5000.0", "0"), "DepthMapFactor"},
      {"a: [1, 2\n", "cam.yaml:"},
      {"a: b\n", "no calibration"},
      {"cam0: 3\n", "cam0"},
      {"---\n- 1\n- 2\n", "no calibration"},
      {"%YAML:1.0\n", "no calibration"},
      {"a: *unknown\n", "cam.yaml:1"},
  };
  for (const auto& one : cases) {
    const auto camera = parse_camera(one.text, "dir/cam.yaml");
    ASSERT_FALSE(camera.is_ok()) << one.text;
    EXPECT_NE(camera.status().message().find(one.part), std::string::npos) << camera.status().message() << "\nexpected: " << one.part;
    EXPECT_TRUE(camera.status().message().starts_with("dir/cam.yaml:")) << camera.status().message();
    EXPECT_EQ(camera.status().message().find('\n'), std::string::npos) << camera.status().message();
  }
}

}  // namespace
}  // namespace camloc
