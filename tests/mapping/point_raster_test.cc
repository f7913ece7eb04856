// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/mapping/picture/point_raster.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

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

Eigen::Vector2d project(const Viewpoint& view, const Eigen::Vector3d& p) {
  const Eigen::Vector3d p_view = view.T_view_world * p;
  const double scale = view.is_perspective ? view.px_per_m / p_view.z() : view.px_per_m;
  return {view.center_u + scale * p_view.x(), view.center_v + scale * p_view.y()};
}

/// A box of 10 x 4 x 2 m, turned about the vertical.
std::vector<Eigen::Vector3d> room(double yaw_rad, const Eigen::Vector3d& center) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-0.5, 0.5);
  const Eigen::AngleAxisd turn(yaw_rad, Eigen::Vector3d::UnitZ());
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 5000; ++i) points.push_back(center + turn * Eigen::Vector3d(10 * unit(random), 4 * unit(random), 2 * unit(random)));
  return points;
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

class FitView : public ::testing::TestWithParam<double> {};

TEST_P(FitView, TopViewFillsThePictureAlongTheLongSide) {
  const double yaw = GetParam();
  const Eigen::Vector3d center(100, -50, 7);
  const auto points = room(yaw, center);
  const Viewpoint view = fit_top_view(points, Eigen::Vector3d::UnitZ(), 1100, 600, 50);
  EXPECT_NEAR(view.px_per_m, 1000 / 9.8, 3);  // 1st to 99th percentile
  const Eigen::Vector3d along = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) * Eigen::Vector3d::UnitX();
  const Eigen::Vector2d middle = project(view, center);
  EXPECT_NEAR(middle.x(), 549.5, 10);
  EXPECT_NEAR(middle.y(), 299.5, 10);
  EXPECT_LT(std::abs((project(view, center + along) - middle).y()), 0.07 * view.px_per_m);
  // From above and not in a mirror: counter-clockwise in the world is counter-clockwise on paper.
  const Eigen::Vector2d x = project(view, center + Eigen::Vector3d::UnitX()) - middle,
                        y = project(view, center + Eigen::Vector3d::UnitY()) - middle;
  EXPECT_LT(x.x() * y.y() - x.y() * y.x(), 0);
  EXPECT_LT((view.T_view_world * (center + Eigen::Vector3d::UnitZ())).z(), (view.T_view_world * center).z());
}

TEST_P(FitView, SideViewHasUpUpAndTheSameRight) {
  const auto points = room(GetParam(), {0, 0, 0});
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const Viewpoint side = fit_side_view(points, up, 1000, 400, 20), top = fit_top_view(points, up, 1000, 400, 20);
  EXPECT_LT(project(side, up).y(), project(side, {0, 0, 0}).y());
  EXPECT_NEAR(project(side, up).x(), project(side, {0, 0, 0}).x(), 1e-6);
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
  EXPECT_LT((side.T_view_world.rotation.inverse() * x - top.T_view_world.rotation.inverse() * x).norm(), 1e-6);
}

TEST_P(FitView, PerspectiveViewFillsThePicture) {
  const auto points = room(GetParam(), {3, 4, 5});
  const Viewpoint view = fit_perspective_view(points, Eigen::Vector3d::UnitZ(), 1000, 700, 40);
  std::size_t num_inside = 0;
  Eigen::Vector2d low(1e9, 1e9), high(-1e9, -1e9);
  for (const Eigen::Vector3d& p : points) {
    ASSERT_GT((view.T_view_world * p).z(), 0.1);
    const Eigen::Vector2d pixel = project(view, p);
    if ((pixel.array() < 39).any() || pixel.x() > 961 || pixel.y() > 661) continue;
    ++num_inside;
    low = low.cwiseMin(pixel);
    high = high.cwiseMax(pixel);
  }
  EXPECT_GT(num_inside, points.size() * 96 / 100);  // 1st to 99th percentile along both sides
  EXPECT_GT(std::max((high.x() - low.x()) / 920, (high.y() - low.y()) / 620), 0.98);
  EXPECT_LT(project(view, {3, 4, 6}).y(), project(view, {3, 4, 5}).y());
}

INSTANTIATE_TEST_SUITE_P(Turned, FitView, ::testing::Values(0.0, 0.4, 1.2, -0.6, 3.0));

TEST(FitViewBadInput, TakesNoPointsAndOnePoint) {
  const Eigen::Vector3d up = Eigen::Vector3d::UnitY();
  const std::vector<Eigen::Vector3d> none, one{{5, 5, 5}}, not_finite{{std::numeric_limits<double>::quiet_NaN(), 0, 0}};
  for (const auto& points : {none, one, not_finite}) {
    for (const auto fit : {fit_top_view, fit_side_view, fit_perspective_view}) {
      const Viewpoint view = fit(points, up, 200, 100, 10);
      EXPECT_TRUE(std::isfinite(view.px_per_m) && view.px_per_m > 0);
      EXPECT_TRUE(view.T_view_world.translation.allFinite() && view.T_view_world.rotation.coeffs().allFinite());
    }
  }
}

}  // namespace
}  // namespace camloc::mapping
