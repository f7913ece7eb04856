// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Against the camera model itself, point by point, and each limit on both of its sides.
#include "core/registration/projection.h"

#include <gtest/gtest.h>

#include <random>

namespace camloc {
namespace {

Intrinsics pinhole() { return {.width = 640, .height = 480, .fx = 520, .fy = 510, .cx = 322, .cy = 236}; }

Intrinsics barrel() {
  Intrinsics color = pinhole();
  color.lens = LensModel::kBrownConrady;
  color.distortion = {-0.25, 0.08, 0.001, -0.002, 0};
  return color;
}

const Rigid3 kPose{exp_so3({0.3, -1.2, 0.5}), {4, -2, 1.3}};

class Projection : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Lens, Projection, ::testing::Bool(),
                         [](const auto& info) { return std::string(info.param ? "Barrel" : "Pinhole"); });

TEST_P(Projection, IsWhatTheCameraModelSays) {
  const Intrinsics color = GetParam() ? barrel() : pinhole();
  LandmarkProjector projector(color, PyramidLevels(1.2F, 8), {.min_depth_m = 0.2, .max_range_m = 8});
  projector.aim(kPose, 9);
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> sideways(-6, 6), ahead(-2, 10);
  int num_inside = 0;
  for (int i = 0; i < 20000; ++i) {
    const Eigen::Vector3d p_camera(sideways(rng), sideways(rng), ahead(rng));
    LandmarkProjector::Seen seen;
    const bool is_in_view = projector.is_in_view((kPose * p_camera).cast<float>(), &seen);
    const bool is_in_range = p_camera.z() > 0.201 && p_camera.z() < 7.999;
    if (p_camera.z() < 0.199 || p_camera.z() > 8.001) { EXPECT_FALSE(is_in_view) << p_camera.transpose(); }
    if (!is_in_range || p_camera.head<2>().norm() > 1.1 * p_camera.z()) continue;
    const Eigen::Vector2d pixel = color.project(p_camera);
    const double inside = std::min({pixel.x(), pixel.y(), 639 - pixel.x(), 479 - pixel.y()});
    if (std::abs(inside) < 0.01) continue;
    EXPECT_EQ(is_in_view, inside > 0) << pixel.transpose();
    if (inside <= 0 || !is_in_view) continue;
    EXPECT_NEAR(seen.u, pixel.x(), 0.01);
    EXPECT_NEAR(seen.v, pixel.y(), 0.01);
    ++num_inside;
  }
  EXPECT_GT(num_inside, 500);
}

TEST_P(Projection, ASphereThatHoldsAVisiblePointMayBeSeen) {
  LandmarkProjector projector(GetParam() ? barrel() : pinhole(), PyramidLevels(1.2F, 8), {});
  projector.aim({}, 9);
  std::mt19937 rng(2);
  std::uniform_real_distribution<double> any(-9, 9), size(0.1, 3);
  int num_seen = 0, num_refused = 0;
  for (int i = 0; i < 20000; ++i) {
    const Eigen::Vector3d center(any(rng), any(rng), any(rng));
    const double radius_m = size(rng);
    const Eigen::Vector3d point = center + radius_m * 0.99 * Eigen::Vector3d(any(rng), any(rng), any(rng)).normalized();
    LandmarkProjector::Seen seen;
    const bool is_seen = projector.is_in_view(point.cast<float>(), &seen), may_be = projector.may_see(center, radius_m);
    if (is_seen) { EXPECT_TRUE(may_be) << center.transpose() << " radius " << radius_m; }
    num_seen += is_seen ? 1 : 0;
    num_refused += may_be ? 0 : 1;
  }
  EXPECT_GT(num_seen, 300);
  EXPECT_GT(num_refused, 10000) << "most are not looked at";
}

TEST(ProjectionLimits, AngleAndLevelDecideWhatIsRecognized) {
  const PyramidLevels levels(1.2F, 8);
  LandmarkProjector projector(pinhole(), levels, {.view_angle_margin_rad = 0.5, .level_margin = 1});
  projector.aim({}, 9);
  LandmarkProjector::Seen seen;
  ASSERT_TRUE(projector.is_in_view({0, 0, 2}, &seen));
  const auto is_recognized = [&](double angle_rad, double widest_rad, double reference_m) {
    const Eigen::Vector3f direction(static_cast<float>(std::sin(angle_rad)), 0, static_cast<float>(-std::cos(angle_rad)));
    const auto log_reference = static_cast<float>(std::log(reference_m));
    ProjectedLandmark out;
    return projector.is_recognizable(seen, direction, static_cast<float>(std::cos(widest_rad)), log_reference, log_reference, &out);
  };
  EXPECT_TRUE(is_recognized(0.69, 0.2, 2));
  EXPECT_FALSE(is_recognized(0.71, 0.2, 2));
  // Seen on level 0 from 2 m: nearer than its reference it is larger, farther it is smaller than any level shows.
  EXPECT_TRUE(is_recognized(0, 0, 2 * std::pow(1.2, 7.9)));
  EXPECT_FALSE(is_recognized(0, 0, 2 * std::pow(1.2, 9.1)));
  EXPECT_TRUE(is_recognized(0, 0, 2 * std::pow(1.2, -1.9)));
  EXPECT_FALSE(is_recognized(0, 0, 2 * std::pow(1.2, -2.1)));
}

}  // namespace
}  // namespace camloc
