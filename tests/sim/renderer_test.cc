// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The renderer against a brute-force ray caster, and against itself from another place.
#include "tools/camloc-sim/renderer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tools/camloc-sim/sensors.h"
#include "tools/camloc-sim/walk.h"

namespace camloc::sim {
namespace {

const World& small_world() {
  static const World world = make_world({SceneKind::kSmall, 1, 1});
  return world;
}

/// Smallest depth along a pixel's ray over all surfaces that face the camera; 0 when it hits nothing.
double cast_ray(const Scene& scene, const Rigid3& T_world_camera, const Intrinsics& camera, double x, double y) {
  const Eigen::Vector3d ray = T_world_camera.rotation * Eigen::Vector3d((x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, 1.0);
  double nearest = 1e9;
  for (const Surface& s : scene.surfaces) {
    const double facing = s.normal().dot(ray);
    if (facing >= 0) continue;
    const double depth = s.normal().dot(s.origin - T_world_camera.translation) / facing;
    if (depth < 0.05 || depth > nearest) continue;
    const Eigen::Vector3d offset = T_world_camera.translation + depth * ray - s.origin;
    const double u = offset.dot(s.u_axis), v = offset.dot(s.v_axis);
    if (u >= 0 && v >= 0 && u <= s.width && v <= s.height) nearest = depth;
  }
  return nearest < 1e8 ? nearest : 0.0;
}

TEST(Renderer, DepthIsThatOfTheNearestSurfaceOnTheRay) {
  const World& world = small_world();
  const Intrinsics camera = simulated_camera().color;
  Renderer renderer(world.scene, camera);
  int num_checked = 0, num_wrong = 0;
  for (const double share : {0.05, 0.3, 0.55, 0.8}) {
    const Rigid3 T_world_camera = world.trajectory.pose(share * world.trajectory.duration_s());
    const Rendering& rendering = renderer.render(T_world_camera, {});
    for (int y = 3; y < 480; y += 13) {
      for (int x = 5; x < 640; x += 17) {
        const double expected = cast_ray(world.scene, T_world_camera, camera, x, y);
        ++num_checked;
        // A ray through the seam of two rectangles may pass either.
        if (std::fabs(rendering.depth_m.at(x, y) - expected) > 1e-4 * expected) ++num_wrong;
      }
    }
  }
  EXPECT_GT(num_checked, 4000);
  EXPECT_LE(num_wrong, num_checked / 500);
}

TEST(Renderer, EveryPixelInsideABuildingSeesSomething) {
  const World& world = small_world();
  Renderer renderer(world.scene, simulated_camera().color);
  for (double t = 0.5; t < world.trajectory.duration_s(); t += 4.0) {
    const Rendering& rendering = renderer.render(world.trajectory.pose(t), {});
    EXPECT_LT(std::count(rendering.surface.pixels.begin(), rendering.surface.pixels.end(), -1), 30) << "at " << t << " s";
  }
}

/// Points seen from one pose land, seen from another, at the depth and with the brightness rendered there, unless occluded.
TEST(Renderer, TwoViewsAgreeInDepthAndBrightness) {
  const World& world = small_world();
  const Intrinsics camera = simulated_camera().color;
  Renderer first(world.scene, camera), second(world.scene, camera);
  const double t = 0.35 * world.trajectory.duration_s();
  const Rigid3 T_world_a = world.trajectory.pose(t), T_world_b = world.trajectory.pose(t + 0.4);
  const Rendering &a = first.render(T_world_a, {}), &b = second.render(T_world_b, {});
  const Rigid3 T_b_a = T_world_b.inverse() * T_world_a;
  std::vector<double> brightness_errors;
  int num_inside = 0, num_in_front = 0;
  for (int y = 2; y < 478; y += 5) {
    for (int x = 2; x < 638; x += 5) {
      const double z = a.depth_m.at(x, y);
      const Eigen::Vector3d p = T_b_a * Eigen::Vector3d((x - camera.cx) / camera.fx * z, (y - camera.cy) / camera.fy * z, z);
      const double u = camera.fx * p.x() / p.z() + camera.cx, v = camera.fy * p.y() / p.z() + camera.cy;
      if (p.z() < 0.1 || u < 1 || v < 1 || u > 638 || v > 478) continue;
      ++num_inside;
      const int iu = static_cast<int>(std::lround(u)), iv = static_cast<int>(std::lround(v));
      const double expected = cast_ray(world.scene, T_world_b, camera, u, v);
      if (p.z() < expected * (1 - 1e-3)) ++num_in_front;  // nothing may be nearer than what the camera sees
      if (std::fabs(p.z() - expected) > 0.01) continue;
      brightness_errors.push_back(std::fabs(std::sqrt(b.radiance.at(iu, iv)) - std::sqrt(a.radiance.at(x, y))));
    }
  }
  EXPECT_GT(num_inside, 5000);
  EXPECT_LE(num_in_front, num_inside / 500);
  ASSERT_GT(brightness_errors.size(), static_cast<std::size_t>(num_inside) / 2);
  std::nth_element(brightness_errors.begin(), brightness_errors.begin() + static_cast<std::ptrdiff_t>(brightness_errors.size() / 2),
                   brightness_errors.end());
  EXPECT_LT(brightness_errors[brightness_errors.size() / 2], 0.02);
}

TEST(Renderer, SameViewSameBits) {
  const World& world = small_world();
  Renderer first(world.scene, simulated_camera().color), second(world.scene, simulated_camera().color);
  (void)second.render(world.trajectory.pose(9.0), {});  // what was drawn before does not matter
  const Rendering &a = first.render(world.trajectory.pose(3.0), {}), &b = second.render(world.trajectory.pose(3.0), {});
  EXPECT_EQ(a.radiance.pixels, b.radiance.pixels);
  EXPECT_EQ(a.depth_m.pixels, b.depth_m.pixels);
}

}  // namespace
}  // namespace camloc::sim
