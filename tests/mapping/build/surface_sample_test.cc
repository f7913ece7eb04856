// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/mapping/build/surface_sample.h"

#include <gtest/gtest.h>

namespace camloc::mapping {
namespace {

RgbdCamera surface_camera() {
  RgbdCamera camera;
  camera.color.width = camera.depth.width = 160;
  camera.color.height = camera.depth.height = 120;
  camera.color.fx = camera.color.fy = camera.depth.fx = camera.depth.fy = 130;
  camera.color.cx = camera.depth.cx = 79.5;
  camera.color.cy = camera.depth.cy = 59.5;
  return camera;
}

TEST(SurfaceSample, PointsLieOnTheSurface) {
  const RgbdCamera camera = surface_camera();
  Image<std::uint16_t> depth;
  depth.resize(160, 120);
  std::fill(depth.pixels.begin(), depth.pixels.end(), std::uint16_t{2000});
  const auto points = sample_surface(camera, depth.view());
  ASSERT_EQ(points.size(), 300U);
  for (const Eigen::Vector3f& p : points) {
    EXPECT_FLOAT_EQ(p.z(), 2);
    EXPECT_LT(std::abs(p.x()), 2 * 80.0F / 130);
    EXPECT_LT(std::abs(p.y()), 2 * 60.0F / 130);
  }
  // Evenly, up to the border: the first and last are mirror images but for the centre of the pixel.
  EXPECT_NEAR(points.front().x(), -points.back().x(), 0.03);
  EXPECT_NEAR(points.front().y(), -points.back().y(), 0.03);
}

TEST(SurfaceSample, HolesAreLeftOut) {
  const RgbdCamera camera = surface_camera();
  Image<std::uint16_t> depth;
  depth.resize(160, 120);
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) depth.at(x, y) = x < 80 ? 0 : (y < 60 ? 65535 : 1500);
  }
  const auto points = sample_surface(camera, depth.view());
  EXPECT_EQ(points.size(), 80U);
  for (const Eigen::Vector3f& p : points) EXPECT_TRUE(p.x() > 0 && p.y() > 0);
  std::fill(depth.pixels.begin(), depth.pixels.end(), std::uint16_t{0});
  EXPECT_TRUE(sample_surface(camera, depth.view()).empty());
}

TEST(SurfaceSample, PointsAreInTheFrameOfTheColourCamera) {
  RgbdCamera camera = surface_camera();
  camera.is_depth_registered = false;
  camera.T_color_depth = {exp_so3({0, 0.1, 0}), {0.025, 0, 0.01}};
  Image<std::uint16_t> depth;
  depth.resize(160, 120);
  std::fill(depth.pixels.begin(), depth.pixels.end(), std::uint16_t{2000});
  for (const Eigen::Vector3f& p : sample_surface(camera, depth.view()))
    EXPECT_NEAR((camera.T_color_depth.inverse() * p.cast<double>()).z(), 2, 1e-5);
}

}  // namespace
}  // namespace camloc::mapping
