// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "core/io/camera_file.h"
#include "tests/io/camera_texts.h"

namespace camloc {
namespace {

const std::string kColor = R"(cam0:
  cam_overlaps: [1]
  camera_model: pinhole
  distortion_coeffs: [0.031, -0.072, 0.0011, -0.0006]
  distortion_model: radtan
  intrinsics: [611.2, 610.7, 318.4, 242.9]
  resolution: [640, 480]
  rostopic: /rgbd/color/image_raw
)";
const std::string kInfrared = R"(cam1:
  T_cn_cnm1:
  - [0.99998, 0.0021, -0.0058, 0.0253]
  - [-0.00208, 0.99999, 0.0033, -0.0004]
  - [0.00581, -0.00329, 0.99998, 0.0012]
  - [0.0, 0.0, 0.0, 1.0]
  camera_model: pinhole
  distortion_coeffs: [-0.091, 0.254, 0.0002, 0.0007]
  distortion_model: radtan
  intrinsics: [582.6, 582.1, 321.7, 236.3]
  resolution: [640, 480]
  rostopic: /rgbd/ir/image_raw
)";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

TEST(CameraKalibr, ColourAndInfraredGiveDepthItsOwnPixels) {
  std::vector<std::string> notes;
  const RgbdCamera camera = parsed(kColor + kInfrared, &notes);
  EXPECT_EQ(camera.color.fx, 611.2);
  EXPECT_FALSE(camera.is_depth_registered);
  EXPECT_EQ(camera.depth.fx, 582.6);
  EXPECT_EQ(camera.depth.cy, 236.3);
  EXPECT_EQ(camera.depth.distortion[1], 0.254);
  EXPECT_LT((1000 * camera.T_color_depth.translation - Eigen::Vector3d(-25.3, 0.4, -1.1)).cwiseAbs().maxCoeff(), 0.1);
  ASSERT_EQ(notes.size(), 2U);
  EXPECT_EQ(notes[0], "cam0 (/rgbd/color/image_raw): colour");
  EXPECT_TRUE(notes[1].starts_with("cam1 (/rgbd/ir/image_raw): infrared")) << notes[1];
}

TEST(CameraKalibr, TheOrderOfTheChainDoesNotMatter) {
  // Infrared first: T_cn_cnm1 of the colour camera takes points of the infrared camera to colour, which is T_color_depth itself.
  std::string first = replaced(kInfrared, "cam1", "cam0"), second = replaced(kColor, "cam0", "cam1");
  const std::size_t from = first.find("  T_cn_cnm1"), to = first.find("  camera_model");
  second += first.substr(from, to - from);
  first.erase(from, to - from);
  const RgbdCamera camera = parsed(first + second);
  EXPECT_EQ(camera.color.fx, 611.2);
  EXPECT_EQ(camera.depth.fx, 582.6);
  EXPECT_NEAR(camera.T_color_depth.translation.x(), 0.0253, 1e-9);
}

TEST(CameraKalibr, EveryOtherCameraIsNamed) {
  std::vector<std::string> notes;
  const std::string third = replaced(replaced(kInfrared, "cam1", "cam2"), "/rgbd/ir/", "/fisheye/");
  const RgbdCamera camera = parsed(kColor + replaced(kInfrared, "/rgbd/ir/", "/left/") + third, &notes);
  EXPECT_TRUE(camera.is_depth_registered);
  ASSERT_EQ(notes.size(), 4U);
  EXPECT_NE(notes[1].find("registered to colour: no camera of the file is an infrared one"), std::string::npos) << notes[1];
  EXPECT_EQ(notes[2], "cam1 (/left/image_raw): left out");
  EXPECT_EQ(notes[3], "cam2 (/fisheye/image_raw): left out");
}

TEST(CameraKalibr, Refuses) {
  expect_error(kColor + replaced(kInfrared, "0.99998, 0.0021", "0.5, 0.0021"), "not a rotation");
  expect_error(kColor + replaced(kInfrared, "  - [0.0, 0.0, 0.0, 1.0]\n", ""), "T_cn_cnm1");
  std::string without = kInfrared;
  without.erase(without.find("  T_cn_cnm1"), without.find("  camera_model") - without.find("  T_cn_cnm1"));
  expect_error(kColor + without, "needs T_cn_cnm1");
}

}  // namespace
}  // namespace camloc
