// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Viewpoints from which points fill a picture, whichever way the building is turned.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "tools/mapping/picture/point_raster.h"

namespace camloc::mapping {
namespace {

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
