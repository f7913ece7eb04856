// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/mapping/picture/point_raster.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/mapping/lightness.h"

namespace camloc::mapping {
namespace {

constexpr Rgb kBlack{0, 0, 0}, kRed{255, 0, 0}, kGreen{0, 255, 0};

Rgb pixel(const PointRaster& raster, int u, int v) {
  const auto* p = raster.image().pixels.data() + 3 * (v * raster.image().width + u);
  return {p[0], p[1], p[2]};
}

int count(const PointRaster& raster, Rgb color) {
  int n = 0;
  for (int v = 0; v < raster.image().height; ++v) {
    for (int u = 0; u < raster.image().width; ++u) n += pixel(raster, u, v) == color;
  }
  return n;
}

TEST(PointRaster, DrawsThePointThatIsNearer) {
  Viewpoint view;
  view.px_per_m = 10;
  view.center_u = view.center_v = 50;
  PointRaster raster(101, 101, kBlack);
  const std::vector<Eigen::Vector3d> near{{1, 2, 1}}, far{{1, 2, 3}, {-1, 0, 3}};
  raster.add_points(view, near, kRed, 0.5);
  raster.add_points(view, far, std::array{kGreen, kGreen}, 0.5);
  EXPECT_EQ(pixel(raster, 60, 70), kRed);
  EXPECT_EQ(pixel(raster, 40, 50), kGreen);
  EXPECT_EQ(count(raster, kRed), 1);
  EXPECT_EQ(count(raster, kGreen), 1);
}

TEST(PointRaster, DrawsDotsOfTheirSize) {
  Viewpoint view;
  view.center_u = view.center_v = 50;
  PointRaster raster(101, 101, kBlack);
  raster.add_points(view, std::array{Eigen::Vector3d(0, 0, 0)}, kRed, 5);
  EXPECT_NEAR(count(raster, kRed), M_PI * 25, 6);
}

TEST(PointRaster, SurvivesWhatIsNotInThePicture) {
  Viewpoint view;
  view.is_perspective = true;
  view.center_u = view.center_v = 50;
  PointRaster raster(101, 101, kBlack);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Eigen::Vector3d> points{{0, 0, -1}, {0, 0, 0}, {nan, 0, 1}, {1e30, 0, 1}, {50, 0, 1}};
  raster.add_points(view, points, kRed, 3);
  raster.add_line(view, points, kRed, 2);
  raster.add_camera(view, Rigid3{Eigen::Quaterniond::Identity(), {0, 0, -5}}, 0.1, kRed);
  raster.add_rectangle(-10, 90, 5, 500, kRed);
  raster.add_text(-50, 500, "outside", 12, kRed);
  EXPECT_EQ(count(raster, kBlack), 101 * 101);
}

TEST(PointRaster, CutsALineAtTheEye) {
  Viewpoint view;
  view.is_perspective = true;
  view.px_per_m = 100;
  view.center_u = view.center_v = 50;
  PointRaster raster(101, 101, kBlack);
  // From 0.4 m below the axis to behind the eye: it comes in at v = 90 and leaves through the upper edge.
  raster.add_line(view, std::array{Eigen::Vector3d(0, 0.4, 1), Eigen::Vector3d(0, -0.8, -1)}, kGreen, 1);
  EXPECT_GT(pixel(raster, 50, 88)[1], 200);
  EXPECT_GT(pixel(raster, 50, 5)[1], 200);
  EXPECT_EQ(pixel(raster, 50, 94), kBlack);
}

TEST(PointRaster, DrawsACameraAsAPyramidThatOpensAhead) {
  Viewpoint view;  // down in the picture is ahead of the camera
  view.T_view_world.rotation = Eigen::AngleAxisd(-M_PI / 2, Eigen::Vector3d::UnitX());
  view.px_per_m = 100;
  view.center_u = view.center_v = 50;
  PointRaster raster(101, 101, kBlack);
  raster.add_camera(view, Rigid3{}, 0.4, kRed);
  double min_u = 1e9, max_u = 0, min_v = 1e9, max_v = 0;
  for (int v = 0; v < 101; ++v) {
    for (int u = 0; u < 101; ++u) {
      if (pixel(raster, u, v) == kBlack) continue;
      min_u = std::min<double>(min_u, u), max_u = std::max<double>(max_u, u);
      min_v = std::min<double>(min_v, v), max_v = std::max<double>(max_v, v);
    }
  }
  EXPECT_NEAR(min_u, 30, 1.5);
  EXPECT_NEAR(max_u, 70, 1.5);
  EXPECT_NEAR(min_v, 50, 1.5);
  EXPECT_NEAR(max_v, 78, 1.5);
}

TEST(PointRaster, DrawsAScaleBarOfARoundLength) {
  Viewpoint view;
  view.px_per_m = 37;
  PointRaster raster(800, 100, kBlack);
  raster.add_scale_bar(view, 20, 50, kRed);  // at most 160 px = 4.3 m: 2 m
  int end = 20;
  while (pixel(raster, end, 50) == kRed) ++end;
  EXPECT_EQ(end - 20, 74);
}

TEST(PointRaster, DrawsALegendWithBothEndsOfTheRamp) {
  PointRaster raster(300, 60, {250, 250, 250});
  raster.add_legend(20, 10, 200, "0", "10 cm", value_ramp());
  EXPECT_EQ(pixel(raster, 20, 15), value_ramp().front());
  EXPECT_EQ(pixel(raster, 219, 15), value_ramp().back());
}

TEST(ValueRamp, GrowsEvenlyInLightness) {
  const auto ramp = value_ramp();
  ASSERT_EQ(ramp.size(), 256U);
  const double step = (lightness_of(ramp.back()) - lightness_of(ramp.front())) / 8;
  EXPECT_GT(step, 8);
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_NEAR(lightness_of(ramp[i == 7 ? 255 : 32 * (i + 1)]) - lightness_of(ramp[32 * i]), step, 1.0) << i;
  }
  EXPECT_NEAR(lightness_of({255, 255, 255}), 100, 0.1);
  EXPECT_NEAR(lightness_of(kBlack), 0, 0.1);
}

}  // namespace
}  // namespace camloc::mapping
