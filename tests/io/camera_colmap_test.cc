// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "core/io/camera_file.h"
#include "tests/io/camera_texts.h"

namespace camloc {
namespace {

TEST(CameraColmap, UsualModelsHalfAPixelLess) {
  const Intrinsics opencv = parsed("# Camera list\n1 OPENCV 640 480 524.1 523.5 317.9 244.6 0.21 -0.59 0.0012 -0.0008\n").color;
  EXPECT_EQ(opencv.width, 640);
  EXPECT_EQ(opencv.fx, 524.1);
  EXPECT_EQ(opencv.fy, 523.5);
  EXPECT_NEAR(opencv.cx, 317.4, 1e-9);
  EXPECT_NEAR(opencv.cy, 244.1, 1e-9);
  EXPECT_EQ(opencv.lens, LensModel::kBrownConrady);
  EXPECT_EQ(opencv.distortion, (std::array<double, 8>{0.21, -0.59, 0.0012, -0.0008}));
  const Intrinsics simple = parsed("7 SIMPLE_RADIAL 640 480 524.1 320 240 0.02\n").color;
  EXPECT_EQ(simple.fx, 524.1);
  EXPECT_EQ(simple.fy, 524.1);
  EXPECT_EQ(simple.cx, 319.5);
  EXPECT_EQ(simple.distortion[0], 0.02);
  EXPECT_EQ(parsed("1 SIMPLE_PINHOLE 640 480 500 320 240\n").color.lens, LensModel::kPinhole);
  EXPECT_EQ(parsed("1 PINHOLE 640 480 500 501 320 240\n").color.fy, 501);
  EXPECT_EQ(parsed("1 RADIAL 640 480 500 320 240 0.1 -0.2\n").color.distortion[1], -0.2);
  EXPECT_EQ(parsed("1 OPENCV_FISHEYE 640 480 500 501 320 240 0.1 0.2 0.3 0.4\n").color.lens, LensModel::kEquidistant);
  EXPECT_EQ(parsed("1 FULL_OPENCV 640 480 500 501 320 240 0.1 0.2 0.01 0.02 0.3 0 0 0\n").color.lens, LensModel::kBrownConrady);
  const Intrinsics full = parsed("1 FULL_OPENCV 640 480 500 501 320 240 0.1 0.2 0.01 0.02 0.3 0.4 0.5 0.6\n").color;
  EXPECT_EQ(full.lens, LensModel::kRational);
  EXPECT_EQ(full.distortion, (std::array<double, 8>{0.1, 0.2, 0.01, 0.02, 0.3, 0.4, 0.5, 0.6}));
}

TEST(CameraColmap, SaysWhatItAssumed) {
  std::vector<std::string> notes;
  const RgbdCamera camera = parsed("3 PINHOLE 640 480 500 501 320 240\n", &notes);
  ASSERT_EQ(notes.size(), 2U);
  EXPECT_NE(notes[0].find("camera 3"), std::string::npos);
  EXPECT_NE(notes[1].find("registered"), std::string::npos);
  EXPECT_TRUE(format_camera_toml(camera, notes).starts_with("# camera 3"));
  EXPECT_EQ(parse_camera(format_camera_toml(camera, notes), "again")->color.fy, 501);
}

TEST(CameraColmap, Refuses) {
  expect_error("1 PINHOLE 640 480 500 501 320 240\n4 PINHOLE 640 480 500 501 320 240\n", "2 cameras (1, 4)");
  expect_error("1 THIN_PRISM_FISHEYE 640 480 500 501 320 240 0 0 0 0 0 0 0 0\n", "'THIN_PRISM_FISHEYE' is not read; SIMPLE_PINHOLE");
  expect_error("1 PINHOLE 640 480 500 320 240\n", "PINHOLE has 4 parameters, not 3");
  expect_error("1 PINHOLE 640 480 500 x 320 240\n", "dir/camera:1: 'x' is not a number");
}

}  // namespace
}  // namespace camloc
