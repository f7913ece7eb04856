// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Keys, defaults and error messages of our own camera file.
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

RgbdCamera camera_of(const std::string& text) {
  const auto camera = parse_camera(text, "dir/cam.toml");
  EXPECT_TRUE(camera.is_ok()) << camera.status().message();
  return camera ? *camera : RgbdCamera{};
}

TEST(CameraToml, ShortFileGetsDefaults) {
  const RgbdCamera camera = camera_of(kGood);
  EXPECT_EQ(camera.name, "cam");
  EXPECT_EQ(camera.color.fx, 525.0);
  EXPECT_TRUE(camera.is_depth_registered);
  EXPECT_EQ(camera.depth.fy, 525.5);
  EXPECT_EQ(camera.depth_unit_m, 0.001);
}

TEST(CameraToml, ErrorsNameFileAndLine) {
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
  };
  for (const auto& one : cases) {
    const auto camera = parse_camera(one.text, "dir/cam.toml");
    ASSERT_FALSE(camera.is_ok()) << one.text;
    EXPECT_NE(camera.status().message().find(one.part), std::string::npos) << camera.status().message() << "\nexpected: " << one.part;
    EXPECT_NE(camera.status().message().find("dir/cam.toml"), std::string::npos) << camera.status().message();
    EXPECT_EQ(camera.status().message().find('\n'), std::string::npos) << camera.status().message();
  }
}

TEST(CameraToml, ValuesThatMakeNoCameraAreRefused) {
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

}  // namespace
}  // namespace camloc
