// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "core/io/camera_file.h"
#include "tests/io/camera_texts.h"

namespace camloc {
namespace {

TEST(CameraJson, Open3dByColumns) {
  const Intrinsics k =
      parsed("{\n\t\"width\" : 640,\n\t\"height\" : 480,\n\t\"intrinsic_matrix\" : [ 525.1, 0, 0, 0, 525.2, 0, 319.5, 239.5, 1 ]\n}").color;
  EXPECT_EQ(k.width, 640);
  EXPECT_EQ(k.fx, 525.1);
  EXPECT_EQ(k.fy, 525.2);
  EXPECT_EQ(k.cx, 319.5);
  EXPECT_EQ(k.cy, 239.5);
  EXPECT_EQ(k.lens, LensModel::kPinhole);
  EXPECT_EQ(parsed("{\"intrinsic\":{\"width\":640,\"height\":480,\"intrinsic_matrix\":[525,0,319.5,0,525,239.5,0,0,1]},\"extrinsic\":[1]}")
                .color.cx,
            319.5);
}

TEST(CameraJson, RealSenseColourAndDepth) {
  std::vector<std::string> notes;
  const RgbdCamera camera = parsed(R"({
    "color": {"width": 640, "height": 480, "fx": 611.2, "fy": 610.7, "ppx": 318.4, "ppy": 242.9, "model": "Inverse Brown Conrady", "coeffs": [0,0,0,0,0]},
    "depth": {"width": 848, "height": 480, "fx": 420.5, "fy": 420.5, "ppx": 423.1, "ppy": 238.7, "model": "Brown Conrady", "coeffs": [0,0,0,0,0]},
    "depth_to_color": {"rotation": [0,1,0, -1,0,0, 0,0,1], "translation": [0.015, 0.0001, -0.0002]},
    "depth_scale": 0.001})",
                                   &notes);
  EXPECT_EQ(camera.color.cx, 318.4);
  EXPECT_FALSE(camera.is_depth_registered);
  EXPECT_EQ(camera.depth.width, 848);
  EXPECT_EQ(camera.depth_unit_m, 0.001);
  EXPECT_LT((camera.T_color_depth * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(0.015, 1.0001, -0.0002)).norm(), 1e-9)
      << "rotation by columns";
  EXPECT_EQ(notes.size(), 2U);
}

TEST(CameraJson, KinectWithEightCoefficients) {
  const Intrinsics k = parsed(R"({"color": {"width": 1280, "height": 720, "fx": 607.1, "fy": 606.9, "cx": 638.2, "cy": 366.4,
    "k1": 0.52, "k2": -2.71, "k3": 1.58, "k4": 0.40, "k5": -2.54, "k6": 1.51, "p1": 0.0006, "p2": -0.0001}})")
                           .color;
  EXPECT_EQ(k.lens, LensModel::kRational);
  EXPECT_EQ(k.distortion, (std::array<double, 8>{0.52, -2.71, 0.0006, -0.0001, 1.58, 0.40, -2.54, 1.51}));
}

TEST(CameraJson, Refuses) {
  expect_error("{\"fx\": 500, \"fy\": 500, \"cx\": 1, \"cy\": 1}", "needs width");
  expect_error(
      "{\"width\": 640, \"height\": 480, \"fx\": 500, \"fy\": 500, \"ppx\": 320, \"ppy\": 240, \"model\": \"inverse_brown_conrady\", "
      "\"coeffs\": [0.1,0,0,0,0]}",
      "inverse Brown-Conrady");
  expect_error("{\"a\": 1}", "no intrinsics of a colour camera");
  expect_error("{\"width\": 640,", "dir/camera:");
  expect_error("{\"width\": 640, \"height\": 480, \"intrinsic_matrix\": [1,2,3,4,5,6,7,8,9]}", "intrinsic_matrix");
}

}  // namespace
}  // namespace camloc
