// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Depth look-up per pixel and whole-image registration, against generated planes and boxes and against each other.
#include "core/geometry/depth_registration.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/geometry/allocation_counter.h"
#include "tests/geometry/registered_depth.h"

namespace camloc {
namespace {

/// As 7-Scenes: depth f = 585, colour f = 525, 2.5 cm apart.
RgbdCamera unregistered_camera() {
  RgbdCamera camera;
  camera.color = {640, 480, 525, 525, 320, 240, LensModel::kPinhole, {}};
  camera.depth = {640, 480, 585, 585, 320, 240, LensModel::kPinhole, {}};
  camera.T_color_depth.translation << -0.025, 0, 0;
  camera.is_depth_registered = false;
  return camera;
}

RgbdCamera registered_camera() {
  RgbdCamera camera = unregistered_camera();
  camera.depth = camera.color;
  camera.T_color_depth = {};
  camera.is_depth_registered = true;
  return camera;
}

/// A slanted wall (z = 3 + 0.3 x in the colour camera) and, where `has_box`, a box front at z = 1.2 before it.
struct World {
  bool has_box;
  /// Distance along `direction` from `origin` in z of the ray's own camera; both cameras have parallel axes.
  [[nodiscard]] double depth_along(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const {
    if (has_box) {
      const Eigen::Vector3d p = origin + (1.2 - origin.z()) / direction.z() * direction;
      if (std::abs(p.x()) < 0.25 && std::abs(p.y()) < 0.2) return 1.2;
    }
    const double t = (3.0 + 0.3 * origin.x() - origin.z()) / (direction.z() - 0.3 * direction.x());
    return origin.z() + t * direction.z();
  }
};

Image<std::uint16_t> render(const RgbdCamera& camera, const World& world) {
  Image<std::uint16_t> depth;
  depth.resize(camera.depth.width, camera.depth.height);
  for (int v = 0; v < depth.height; ++v) {
    for (int u = 0; u < depth.width; ++u) {
      const Eigen::Vector2d n = camera.depth.undistort(Eigen::Vector2d(u, v));
      const double z = world.depth_along(camera.T_color_depth.translation, {n.x(), n.y(), 1});
      depth.at(u, v) = static_cast<std::uint16_t>(std::lround(z / camera.depth_unit_m));
    }
  }
  return depth;
}

double truth_at(const RgbdCamera& camera, const World& world, int u, int v) {
  const Eigen::Vector2d n = camera.color.undistort(Eigen::Vector2d(u, v));
  return world.depth_along(Eigen::Vector3d::Zero(), {n.x(), n.y(), 1});
}

TEST(DepthLookup, FindsASmoothWallFromUnregisteredDepth) {
  const RgbdCamera camera = unregistered_camera();
  const World world{false};
  const Image<std::uint16_t> depth = render(camera, world);
  const DepthLookup lookup(camera);
  int num_found = 0, num_asked = 0;
  for (int v = 40; v < 440; v += 5) {
    for (int u = 60; u < 580; u += 5) {
      ++num_asked;
      const float z = lookup.depth_at(depth.view(), static_cast<float>(u), static_cast<float>(v));
      if (z == 0.0F) continue;
      ++num_found;
      EXPECT_NEAR(z, truth_at(camera, world, u, v), 0.004);
    }
  }
  EXPECT_EQ(num_found, num_asked);
}

TEST(DepthLookup, NeverMixesForegroundAndBackground) {
  for (const RgbdCamera& camera : {unregistered_camera(), registered_camera()}) {
    const World world{true};
    const Image<std::uint16_t> depth = render(camera, world);
    const DepthLookup lookup(camera);
    int num_found = 0, num_wrong = 0, num_asked = 0;
    for (int v = 40; v < 440; v += 3) {
      for (int u = 60; u < 580; u += 1) {
        ++num_asked;
        const float z = lookup.depth_at(depth.view(), static_cast<float>(u), static_cast<float>(v));
        num_found += z > 0 ? 1 : 0;
        num_wrong += z > 0 && std::abs(z - truth_at(camera, world, u, v)) > 0.05 ? 1 : 0;
      }
    }
    EXPECT_GT(num_found, num_asked * 95 / 100);
    // A pixel on the contour itself may fall to either side by rounding.
    EXPECT_LT(num_wrong, num_asked / 200);
  }
}

TEST(DepthLookup, AgreesWithRegistration) {
  const RgbdCamera camera = unregistered_camera();
  const Image<std::uint16_t> depth = render(camera, World{true});
  const DepthLookup lookup(camera);
  Image<float> registered;
  testing::register_depth(camera, depth.view(), &registered);
  ASSERT_EQ(registered.width, 640);
  ASSERT_EQ(registered.height, 480);
  int num_both = 0, num_apart = 0;
  for (int v = 40; v < 440; v += 3) {
    for (int u = 60; u < 580; u += 1) {
      const float z = lookup.depth_at(depth.view(), static_cast<float>(u), static_cast<float>(v));
      if (z == 0.0F || registered.at(u, v) == 0.0F) continue;
      ++num_both;
      num_apart += std::abs(z - registered.at(u, v)) > 0.01F * z ? 1 : 0;
    }
  }
  EXPECT_GT(num_both, 60000);
  EXPECT_LT(num_apart, num_both / 200);
}

TEST(DepthRegistration, NearestSurfaceWinsAndImageHasNoHoles) {
  RgbdCamera camera = unregistered_camera();
  camera.color.fx = camera.color.fy = 800;  // colour finer than depth: each depth pixel covers several
  const World world{true};
  Image<float> registered;
  const Image<std::uint16_t> depth = render(camera, world);
  testing::register_depth(camera, depth.view(), &registered);
  int num_holes = 0, num_wrong = 0, num_asked = 0;
  for (int v = 40; v < 440; ++v) {
    for (int u = 40; u < 600; ++u) {
      ++num_asked;
      const float z = registered.at(u, v);
      num_holes += z == 0.0F ? 1 : 0;
      num_wrong += z > 0.0F && std::abs(z - truth_at(camera, world, u, v)) > 0.05 ? 1 : 0;
    }
  }
  // What the box hides from the depth camera is a true hole: 10 px wide along one side of the box.
  EXPECT_LT(num_holes, num_asked * 2 / 100);
  EXPECT_LT(num_wrong, num_asked / 100);
}

TEST(DepthLookup, RegisteredDepthIsTheNearestPixel) {
  const RgbdCamera camera = registered_camera();
  Image<std::uint16_t> depth;
  depth.resize(640, 480);
  for (int v = 0; v < 480; ++v) {
    for (int u = 0; u < 640; ++u) depth.at(u, v) = static_cast<std::uint16_t>(1000 + u / 10);
  }
  const DepthLookup lookup(camera);
  EXPECT_FLOAT_EQ(lookup.depth_at(depth.view(), 99.6F, 50.0F), 1.010F);
  EXPECT_FLOAT_EQ(lookup.depth_at(depth.view(), 99.4F, 50.0F), 1.009F);
  EXPECT_FLOAT_EQ(lookup.depth_at(depth.view(), 0, 0), 1.0F);
  EXPECT_EQ(lookup.depth_at(depth.view(), 640, 0), 0.0F);
  EXPECT_EQ(lookup.depth_at(depth.view(), -3, 0), 0.0F);
  EXPECT_EQ(lookup.depth_at(depth.view(), 0, 480), 0.0F);
}

TEST(DepthLookup, GivesNothingForInvalidDepth) {
  for (const RgbdCamera& camera : {unregistered_camera(), registered_camera()}) {
    const DepthLookup lookup(camera);
    EXPECT_EQ(lookup.depth_at({}, 320, 240), 0.0F);
    Image<std::uint16_t> depth;
    depth.resize(640, 480);
    EXPECT_EQ(lookup.depth_at(depth.view(), 320, 240), 0.0F);
    std::fill(depth.pixels.begin(), depth.pixels.end(), std::uint16_t{65535});
    EXPECT_EQ(lookup.depth_at(depth.view(), 320, 240), 0.0F);
    Image<float> registered;
    testing::register_depth(camera, depth.view(), &registered);
    EXPECT_EQ(*std::max_element(registered.pixels.begin(), registered.pixels.end()), 0.0F);
    testing::register_depth(camera, {}, &registered);
    EXPECT_EQ(registered.pixels.size(), 640U * 480U);
    // An image smaller than the camera says must not be read beyond its end.
    depth.resize(16, 1);
    EXPECT_EQ(lookup.depth_at(depth.view(), 320, 240), 0.0F);
    testing::register_depth(camera, depth.view(), &registered);
  }
}

TEST(DepthLookup, AllocatesNothing) {
  if (!testing::can_count_allocations()) GTEST_SKIP() << "a sanitizer owns the allocator";
  const RgbdCamera camera = unregistered_camera();
  const Image<std::uint16_t> depth = render(camera, World{true});
  const DepthLookup lookup(camera);
  const std::uint64_t before = testing::num_allocations();
  float sum = 0;
  for (int u = 0; u < 640; ++u) sum += lookup.depth_at(depth.view(), static_cast<float>(u), 240);
  EXPECT_EQ(testing::num_allocations(), before);
  EXPECT_GT(sum, 0.0F);
}

}  // namespace
}  // namespace camloc
