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
  EXPECT_EQ(tum->color.distortion, (std::array<double, 5>{0.2624, -0.9531, -0.0054, 0.0026, 1.1633}));
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

TEST(CameraFile, ShortFileGetsDefaults) {
  const RgbdCamera camera = camera_of(kGood);
  EXPECT_EQ(camera.name, "cam");
  EXPECT_EQ(camera.color.fx, 525.0);
  EXPECT_TRUE(camera.is_depth_registered);
  EXPECT_EQ(camera.depth.fy, 525.5);
  EXPECT_EQ(camera.depth_unit_m, 0.001);
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

TEST(CameraFile, ErrorsNameFileAndLine) {
  const std::string good = kGood;
  const struct {
    std::string text;
    const char* part;
  } cases[] = {
      {good + "fz = 1\n", "cam.toml:8: unknown key 'fz' in [color]"},
      {"nane = \"x\"\n" + good, "cam.toml:1: unknown key 'nane'"},
      {good + "[dept]\n", "cam.toml:8: unknown key 'dept'"},
      {"[color]\nwidth = 640\n", "cam.toml:1: [color] needs height"},
      {"name = \"x\"\n", "[color] is missing"},
      {"[color]\nwidth = \"640\"\n", "cam.toml:2: width: expected 1 to 16384 pixels"},
      {"[color]\nwidth = 0\n", "cam.toml:2: width"},
      {"[color]\nwidth = 640\nheight = 480\nfx = \"5\"\n", "cam.toml:4: fx: expected a number"},
      {"[color]\nwidth = 640\nheight = 480\nfx = nan\n", "cam.toml:4: fx: expected a number"},
      {good + "lens = \"fisheye\"\n", "expected one of pinhole, brown_conrady, equidistant"},
      {good + "lens = 3\n", "cam.toml:8: lens: expected a text"},
      {good + "lens = \"brown_conrady\"\n", "needs distortion"},
      {good + "lens = \"brown_conrady\"\ndistortion = [1, 2, 3]\n", "cam.toml:9: distortion: expected 4 to 5 numbers"},
      {good + "lens = \"equidistant\"\ndistortion = [1, 2, 3, \"x\"]\n", "cam.toml:9: distortion"},
      {good + "distortion = [0, 0, 0, 0, 0]\n", "cam.toml:8: distortion: a pinhole lens has none"},
      {good + "[depth]\nregistered = true\nfx = 585\n", "cam.toml:10: fx: registered depth"},
      {good + "[depth]\nregistered = 1\n", "cam.toml:9: registered: expected true or false"},
      {good + "[depth]\nregistered = false\n", "[depth] needs width"},
      {good + "[depth]\nwidth = 640\nheight = 480\nfx = 1\nfy = 1\ncx = 1\ncy = 1\n", "[extrinsics] is missing"},
      {good + "[extrinsics]\ntranslation_m = [0, 0, 0]\nrotation_wxyz = [1, 1, 0, 0]\n", "not of unit length"},
      {good + "[extrinsics]\ntranslation_m = [0, 0]\n", "translation_m: expected 3 numbers"},
      {good + "[poses]\ncamera = \"left\"\n", "cam.toml:9: camera: 'left'"},
      {"color = 3\n", "expected a table [color]"},
      {"[color\n", "cam.toml:1: "},
      {good + "width = 5\n", "cam.toml:8: "},
      {"", "no camera file"},
      {"just some words\n", "no camera file"},
  };
  for (const auto& one : cases) {
    const auto camera = parse_camera(one.text, "dir/cam.toml");
    ASSERT_FALSE(camera.is_ok()) << one.text;
    EXPECT_NE(camera.status().message().find(one.part), std::string::npos) << camera.status().message() << "\nexpected: " << one.part;
    EXPECT_NE(camera.status().message().find("dir/cam.toml"), std::string::npos) << camera.status().message();
    EXPECT_EQ(camera.status().message().find('\n'), std::string::npos) << camera.status().message();
  }
}

TEST(CameraFile, ValuesThatMakeNoCameraAreRefused) {
  for (const char* line : {"fx = -525\n", "fx = 0\n", "cx = 1e9\n"}) {
    const std::string text =
        std::string("[color]\nwidth = 640\nheight = 480\nfy = 525\ncy = 240\n") + (line[0] == 'f' ? "cx = 320\n" : "fx = 525\n") + line;
    const auto camera = parse_camera(text, "cam.toml");
    ASSERT_FALSE(camera.is_ok()) << line;
    EXPECT_TRUE(camera.status().message().starts_with("cam.toml")) << camera.status().message();
  }
  for (const char* depth : {"unit_m = 0\n", "unit_m = -1\n", "min_m = 5\nmax_m = 1\n"}) {
    EXPECT_FALSE(parse_camera(std::string(kGood) + "[depth]\n" + depth, "cam.toml").is_ok()) << depth;
  }
}

TEST(CameraFile, MissingFile) {
  EXPECT_EQ(read_camera_file("/no/such.toml").status().code(), ErrorCode::kNotFound);
  EXPECT_NE(read_camera_file("/").status().message().find("is a folder"), std::string::npos);
}

}  // namespace
}  // namespace camloc
