// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "core/io/camera_file.h"
#include "tests/io/camera_texts.h"

namespace camloc {
namespace {

const char* const kXml = R"(<?xml version="1.0"?>
<!-- a comment <with> tags -->
<opencv_storage>
<calibration_time>"Tue 1 Dec 2026"</calibration_time>
<image_width>640</image_width>
<image_height>480</image_height>
<flags/>
<camera_matrix type_id="opencv-matrix">
  <rows>3</rows>
  <cols>3</cols>
  <dt>d</dt>
  <data>
    5.2410000000000002e+02 0. 3.1740000000000001e+02 0.
    5.2350000000000000e+02 2.4410000000000000e+02 0. 0. 1.</data></camera_matrix>
<distortion_coefficients type_id="opencv-matrix">
  <rows>5</rows>
  <cols>1</cols>
  <dt>d</dt>
  <data>
    2.1e-01 -5.9e-01 1.2e-03 -8.0e-04 5.1e-01</data></distortion_coefficients>
</opencv_storage>
)";

TEST(CameraXml, OpenCvCalibration) {
  const Intrinsics k = parsed(kXml).color;
  EXPECT_EQ(k.width, 640);
  EXPECT_EQ(k.height, 480);
  EXPECT_EQ(k.fx, 524.1);
  EXPECT_EQ(k.fy, 523.5);
  EXPECT_NEAR(k.cx, 317.4, 1e-12);
  EXPECT_EQ(k.cy, 244.1);
  EXPECT_EQ(k.distortion, (std::array<double, 8>{0.21, -0.59, 0.0012, -0.0008, 0.51}));
}

TEST(CameraXml, DamageIsNamed) {
  const std::string whole = kXml;
  for (std::size_t length = 1; length + 20 < whole.size(); length += 7) {
    const auto camera = parse_camera(whole.substr(0, length), "dir/camera");
    EXPECT_FALSE(camera.is_ok()) << length;
  }
  expect_error("<html><body>404</body></html>", "expected <opencv_storage>, found <html>");
  expect_error("<opencv_storage><a></b></opencv_storage>", "dir/camera:1: XML: '/b' does not end 'a'");
  expect_error("<opencv_storage><a>1</a></opencv_storage>", "no calibration");
  std::string deep = "<opencv_storage>";
  for (int i = 0; i < 1000; ++i) deep += "<a>";
  expect_error(deep, "too deep");
}

}  // namespace
}  // namespace camloc
