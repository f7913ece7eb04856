// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/camera_file.h"

#include "tests/drivers/test_folder.h"

namespace camloc {
namespace {

const char* const kGood = R"([color]
width = 640
height = 480
fx = 525
fy = 525.5
cx = 319.5
cy = 239.5
)";

void expect_same(const RgbdCamera& a, const RgbdCamera& b) {
  EXPECT_EQ(a.name, b.name);
  for (const auto& [x, y] : {std::pair(&a.color, &b.color), std::pair(&a.depth, &b.depth)}) {
    EXPECT_EQ(x->width, y->width);
    EXPECT_EQ(x->height, y->height);
    EXPECT_EQ(x->fx, y->fx);
    EXPECT_EQ(x->fy, y->fy);
    EXPECT_EQ(x->cx, y->cx);
    EXPECT_EQ(x->cy, y->cy);
    EXPECT_EQ(x->lens, y->lens);
    EXPECT_EQ(x->distortion, y->distortion);
  }
  EXPECT_EQ(a.T_color_depth.translation, b.T_color_depth.translation);
  EXPECT_EQ(a.T_color_depth.rotation.coeffs(), b.T_color_depth.rotation.coeffs());
  EXPECT_EQ(a.is_depth_registered, b.is_depth_registered);
  EXPECT_EQ(a.depth_unit_m, b.depth_unit_m);
  EXPECT_EQ(a.min_depth_m, b.min_depth_m);
  EXPECT_EQ(a.max_depth_m, b.max_depth_m);
  EXPECT_EQ(a.depth_noise.constant_m, b.depth_noise.constant_m);
  EXPECT_EQ(a.depth_noise.quadratic_per_m, b.depth_noise.quadratic_per_m);
  EXPECT_EQ(a.poses_are_of_depth_camera, b.poses_are_of_depth_camera);
}

RgbdCamera camera_of(const std::string& text) {
  const auto camera = parse_camera(text, "dir/cam.toml");
  EXPECT_TRUE(camera.is_ok()) << camera.status().message();
  return camera ? *camera : RgbdCamera{};
}

TEST(CameraFile, EveryShippedFileIsReadAndRoundTrips) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(source_folder() / "config/cameras")) {
    const auto camera = read_camera_file(entry.path().string());
    ASSERT_TRUE(camera.is_ok()) << camera.status().message();
    EXPECT_EQ(camera->name, entry.path().stem().string());
    expect_same(camera_of(format_camera_toml(*camera)), *camera);
    ++count;
  }
  EXPECT_GE(count, 3);
}

TEST(CameraFile, ShippedValues) {
  const std::string folder = (source_folder() / "config/cameras").string();
  const auto tum = read_camera_file(folder + "/tum-fr1.toml");
  ASSERT_TRUE(tum.is_ok());
  EXPECT_EQ(tum->color.lens, LensModel::kBrownConrady);
  EXPECT_EQ(tum->color.distortion, (std::array<double, 8>{0.2624, -0.9531, -0.0054, 0.0026, 1.1633}));
  EXPECT_EQ(tum->depth_unit_m, 0.0002);
  EXPECT_TRUE(tum->is_depth_registered);
  EXPECT_EQ(tum->depth.fx, 517.3);
  const auto scenes = read_camera_file(folder + "/7scenes.toml");
  ASSERT_TRUE(scenes.is_ok());
  EXPECT_FALSE(scenes->is_depth_registered);
  EXPECT_EQ(scenes->depth.fx, 585.0);
  EXPECT_EQ(scenes->color.fx, 525.0);
  EXPECT_EQ((scenes->T_color_depth * Eigen::Vector3d(0, 0, 1)), Eigen::Vector3d(-0.025, 0, 1));
  EXPECT_TRUE(scenes->poses_are_of_depth_camera);
  EXPECT_EQ(scenes->depth_m(65535), 0.0F);
}

TEST(CameraFile, OddNumbersRoundTripToTheLastBit) {
  RgbdCamera camera = camera_of(kGood);
  camera.name = "a \"quoted\" \\ name\n";
  camera.color.fx = 525.0 + 1.0 / 3;
  camera.color.lens = LensModel::kEquidistant;
  camera.color.distortion = {1e-17, -0.1, 1.0 / 7, 2e-5, 0};
  camera.depth = camera.color;
  camera.depth.cx = 0.1 + 0.2;
  camera.is_depth_registered = false;
  camera.T_color_depth = {exp_so3({0.1, -0.2, 0.3}), {-0.0251234567890123, 1e-9, 0}};
  camera.depth_unit_m = 1 / 5000.0;
  camera.poses_are_of_depth_camera = true;
  expect_same(camera_of(format_camera_toml(camera)), camera);
}

TEST(CameraFile, TheContentTellsTheKind) {
  for (const char* text : {"", "# only a comment\n", "just some words\n"}) {
    const auto camera = parse_camera(text, "cam.toml");
    ASSERT_FALSE(camera.is_ok()) << text;
    EXPECT_NE(camera.status().message().find("cam.toml: no camera file"), std::string::npos) << camera.status().message();
  }
  // A TOML file named .yaml, and a YAML file (of ROS) named .toml.
  EXPECT_EQ(parse_camera(kGood, "cam.yaml")->color.fx, 525.0);
  const auto ros = parse_camera(
      "image_width: 640\nimage_height: 480\ncamera_name: ros\ndistortion_model: plumb_bob\n"
      "camera_matrix:\n  rows: 3\n  cols: 3\n  data: [500, 0, 320, 0, 501, 240, 0, 0, 1]\n"
      "distortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [0, 0, 0, 0, 0]\n",
      "cam.toml");
  ASSERT_TRUE(ros.is_ok()) << ros.status().message();
  EXPECT_EQ(ros->color.fy, 501.0);
}

TEST(CameraFile, MissingFile) {
  EXPECT_EQ(read_camera_file("/no/such.toml").status().code(), ErrorCode::kNotFound);
  EXPECT_NE(read_camera_file("/").status().message().find("is a folder"), std::string::npos);
}

}  // namespace
}  // namespace camloc
