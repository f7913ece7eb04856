// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/ar_projection.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <random>
#include <string>

namespace camloc {
namespace {

const Intrinsics kOffCentre{640, 480, 525, 518, 351.25, 217.75};
constexpr ClipPlanes kPlanes{0.1, 50};

Rigid3 random_pose(std::mt19937_64* random) {
  std::uniform_real_distribution<double> metre(-20, 20), turn(-3, 3);
  return {exp_so3({turn(*random), turn(*random), turn(*random)}), {metre(*random), metre(*random), metre(*random)}};
}

class ArProjection : public ::testing::TestWithParam<const char*> {
 protected:
  const EngineConvention& engine_ = *find_engine(GetParam());
};

// The bar: 10,000 points through K and pose, and through the engine's own matrices.
TEST_P(ArProjection, DrawsPointsWhereTheCameraSeesThem) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> across(-0.6, 0.6), depth(0.11, 49);
  double largest = 0;
  for (int i = 0; i < 10000; ++i) {
    const Rigid3 pose = random_pose(&random);
    const double z = depth(random);
    const Eigen::Vector3d p_camera(across(random) * z, across(random) * z, z);
    const auto drawn =
        draw_point(engine_, virtual_camera(engine_, kOffCentre, pose, kPlanes), engine_point(engine_, pose * p_camera), 640, 480);
    ASSERT_TRUE(drawn);
    largest = std::max(largest, (drawn->pixel - kOffCentre.project(p_camera)).norm());
    const double low = std::min(engine_.z_near, engine_.z_far), high = std::max(engine_.z_near, engine_.z_far);
    EXPECT_GE(drawn->depth, low);
    EXPECT_LE(drawn->depth, high);
  }
  EXPECT_LT(largest, 1e-9);
}

TEST_P(ArProjection, PlanesHaveTheDepthOfTheEngine) {
  const Rigid3 pose{exp_so3({0.1, -0.4, 0.2}), {1, 2, 3}};
  const VirtualCamera camera = virtual_camera(engine_, kOffCentre, pose, kPlanes);
  const auto depth_at = [&](double z) {
    return draw_point(engine_, camera, engine_point(engine_, pose * Eigen::Vector3d(0.01, 0.02, z)), 640, 480)->depth;
  };
  EXPECT_NEAR(depth_at(kPlanes.near_m), engine_.z_near, 1e-9);
  EXPECT_NEAR(depth_at(kPlanes.far_m), engine_.z_far, 1e-9);
  EXPECT_FALSE(draw_point(engine_, camera, engine_point(engine_, pose * Eigen::Vector3d(0, 0, -1)), 640, 480));
}

// A view matrix moves and turns things and mirrors nothing that its world does not.
TEST_P(ArProjection, TheViewKeepsLengthsAndItsHandedness) {
  const VirtualCamera camera = virtual_camera(engine_, kOffCentre, {exp_so3({1, -2, 0.3}), {4, 5, 6}}, kPlanes);
  const Eigen::Matrix3d R = camera.view.topLeftCorner<3, 3>();
  EXPECT_LT((R * R.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
  const double expected = engine_.R_eye_camera.determinant() * engine_.R_world_map.determinant();
  EXPECT_NEAR(R.determinant(), expected, 1e-12);
}
INSTANTIATE_TEST_SUITE_P(Engines, ArProjection, ::testing::Values("opengl", "webxr", "vulkan", "direct3d", "irrlicht", "unity", "unreal"),
                         [](const auto& of) { return std::string(of.param); });

// The formulas of the OpenGL frustum (glFrustum), written out by hand.
TEST(ArProjectionOpenGl, IsTheOffAxisFrustum) {
  const auto projection = virtual_camera(*find_engine("opengl"), kOffCentre, {}, kPlanes).projection;
  const double n = 0.1, f = 50;
  EXPECT_NEAR(projection(0, 0), 2 * 525.0 / 640, 1e-12);
  EXPECT_NEAR(projection(0, 2), 1 - 2 * (351.25 + 0.5) / 640, 1e-12);
  EXPECT_NEAR(projection(1, 1), 2 * 518.0 / 480, 1e-12);
  EXPECT_NEAR(projection(1, 2), 2 * (217.75 + 0.5) / 480 - 1, 1e-12);
  EXPECT_NEAR(projection(2, 2), (f + n) / (n - f), 1e-12);
  EXPECT_NEAR(projection(2, 3), 2 * f * n / (n - f), 1e-12);
  EXPECT_EQ(projection(3, 2), -1);
  EXPECT_EQ(elements(projection)[11], -1) << "column by column: the last row's third number";
}

// Eq. 10 to 13 of the paper, where V0 = Y + Width / 2 is a misprint for Height / 2: r and t are where the near plane ends.
TEST(ArProjectionPaper, IsTheSymmetricSpecialCase) {
  const Intrinsics centred{640, 480, 525, 520, 319.5, 239.5};  // the middle of 640 x 480 pixels whose centres are at integers
  const auto projection = virtual_camera(*find_engine("direct3d"), centred, {}, kPlanes).projection;
  const double n = kPlanes.near_m, r = n * 640 / (2 * 525.0), t = n * 480 / (2 * 520.0);
  EXPECT_NEAR(projection(0, 0), n / r, 1e-12);
  EXPECT_NEAR(projection(1, 1), n / t, 1e-12);
  EXPECT_NEAR(projection(0, 2), 0, 1e-12);
  EXPECT_NEAR(projection(1, 2), 0, 1e-12);
}

// With x to the east and z up: what is north of the origin.
TEST(ArProjectionWorlds, NorthAndUpAreWhereTheEnginesHaveThem) {
  const Eigen::Vector3d north(0, 1, 0), up(0, 0, 1);
  const std::pair<const char*, std::array<Eigen::Vector3d, 2>> expected[] = {
      {"opengl", {{{0, 0, -1}, {0, 1, 0}}}}, {"unity", {{{0, 0, 1}, {0, 1, 0}}}}, {"unreal", {{{0, -100, 0}, {0, 0, 100}}}}};
  for (const auto& [name, points] : expected) {
    EXPECT_EQ(engine_point(*find_engine(name), north), points[0]) << name;
    EXPECT_EQ(engine_point(*find_engine(name), up), points[1]) << name;
  }
  EXPECT_EQ(find_engine("quake"), nullptr);
}

TEST(Letterbox, KeepsTheShapeOfTheImage) {
  const Viewport wide = letterbox(640, 480, 1920, 1080);
  EXPECT_EQ(wide.x, 240);
  EXPECT_EQ(wide.y, 0);
  EXPECT_EQ(wide.width, 1440);
  EXPECT_EQ(wide.height, 1080);
  const Viewport tall = letterbox(640, 480, 480, 800);
  EXPECT_EQ(tall.x, 0);
  EXPECT_EQ(tall.y, 220);
  EXPECT_EQ(tall.width, 480);
  EXPECT_EQ(tall.height, 360);
}

TEST(UndistortionMesh, DrawsEveryPixelWhereAPinholeSeesIt) {
  Intrinsics lens{640, 480, 517, 516, 318, 255, LensModel::kBrownConrady, {0.26, -0.95, -0.005, 0.002, 1.16}};
  const UndistortionMesh mesh = undistortion_mesh(lens, 33, 25);
  ASSERT_EQ(mesh.texture.size(), 33U * 25U);
  Intrinsics pinhole = lens;
  pinhole.lens = LensModel::kPinhole;
  pinhole.distortion = {};
  for (std::size_t i = 0; i < mesh.texture.size(); ++i) {
    const Eigen::Vector2d straight = mesh.positions[i].cwiseProduct(Eigen::Vector2d(640, 480)) - Eigen::Vector2d(0.5, 0.5);
    const Eigen::Vector3d ray((straight.x() - 318) / 517, (straight.y() - 255) / 516, 1);
    const Eigen::Vector2d seen = lens.project(ray),
                          there = mesh.texture[i].cwiseProduct(Eigen::Vector2d(640, 480)) - Eigen::Vector2d(0.5, 0.5);
    EXPECT_LT((seen - there).norm(), 1e-3) << i;
    EXPECT_LT((pinhole.project(ray) - straight).norm(), 1e-9);
  }
}

}  // namespace
}  // namespace camloc
