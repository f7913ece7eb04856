// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/camloc-sim/sensors.h"

#include <gtest/gtest.h>

#include <cmath>

namespace camloc::sim {
namespace {

/// A wall filling the view at distance z, facing a camera at the origin that looks along +x of the world.
Scene wall_at(double z, Material material) {
  Scene scene;
  scene.add_upright({}, z, 20, z, -20, -20, 20, {material, 5, 0.6F}, 0);
  scene.bake_light();
  return scene;
}

Rigid3 looking_along_x() {
  Eigen::Matrix3d R;
  R << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return {Eigen::Quaterniond(R), Eigen::Vector3d::Zero()};
}

struct DepthStatistics {
  double mean = 0, sigma = 0, share_valid = 0;
};

DepthStatistics measure_wall(double z, bool is_perfect) {
  const Scene scene = wall_at(z, Material::kPaint);
  const RgbdCamera camera = simulated_camera();
  Renderer renderer(scene, camera.color);
  DepthSensor sensor(camera.color, is_perfect);
  Image<std::uint16_t> depth;
  double sum = 0, squares = 0;
  int count = 0, all = 0;
  // The steps make the error depend on where between two of them the wall stands: average over positions of the sensor.
  for (std::uint32_t k = 0; k < 6; ++k) {
    Rigid3 T_world_camera = looking_along_x();
    T_world_camera.translation.x() = 0.0013 * z * z * k;
    sensor.measure(renderer.render(T_world_camera, {}), renderer, 77 + k, &depth);
    const double truth = z - T_world_camera.translation.x();
    for (const std::uint16_t raw : depth.pixels) {
      ++all;
      if (raw == 0) continue;
      const double error = raw * camera.depth_unit_m - truth;
      sum += error;
      squares += error * error;
      ++count;
    }
  }
  if (count == 0) return {};
  const double mean = sum / count;
  return {mean, std::sqrt(squares / count - mean * mean), static_cast<double>(count) / all};
}

TEST(DepthSensor, NoiseGrowsWithTheSquareOfDistanceAsDeclared) {
  const DepthNoise declared = simulated_camera().depth_noise;
  for (const double z : {1.0, 2.0, 3.0, 4.5}) {
    const DepthStatistics measured = measure_wall(z, false);
    EXPECT_NEAR(measured.sigma, declared.quadratic_per_m * z * z, 0.2 * declared.quadratic_per_m * z * z) << z;
    EXPECT_LT(std::fabs(measured.mean), 0.5 * measured.sigma) << z;
    EXPECT_GT(measured.share_valid, 0.95) << z;
  }
}

TEST(DepthSensor, SeesNothingOutOfRange) {
  EXPECT_EQ(measure_wall(0.4, false).share_valid, 0.0);
  EXPECT_EQ(measure_wall(6.0, false).share_valid, 0.0);
}

TEST(DepthSensor, PerfectDepthIsExactToHalfAUnit) {
  const DepthStatistics measured = measure_wall(3.0, true);
  EXPECT_EQ(measured.share_valid, 1.0);
  EXPECT_LT(std::fabs(measured.mean), 0.0001);
  EXPECT_LT(measured.sigma, 0.0001);
}

TEST(DepthSensor, AnObjectCastsAShadowOnItsLeft) {
  Scene scene = wall_at(3.0, Material::kPaint);
  scene.add_upright({}, 1.0, 0.2, 1.0, -0.2, -5, 5, {Material::kPaint, 6, 0.6F}, 0);
  scene.bake_light();
  const RgbdCamera camera = simulated_camera();
  Renderer renderer(scene, camera.color);
  DepthSensor sensor(camera.color, false);
  Image<std::uint16_t> depth;
  sensor.measure(renderer.render(looking_along_x(), {}), renderer, 1, &depth);
  const auto count_missing = [&](int from, int to) {
    int missing = 0;
    for (int y = 0; y < 480; ++y) {
      for (int x = from; x < to; ++x) missing += depth.at(x, y) == 0;
    }
    return static_cast<double>(missing) / (480 * (to - from));
  };
  // Edges at 319.5 +- 105; the shadow is f b (1/1 - 1/3) = 26 px wide.
  EXPECT_GT(count_missing(190, 213), 0.95);
  EXPECT_LT(count_missing(427, 450), 0.05);
  EXPECT_LT(count_missing(150, 185), 0.05);
}

TEST(ColorSensor, ExposureSettlesAtTheTargetWithinASecond) {
  std::vector<float> tones(60, 0.2F);
  std::fill(tones.begin() + 30, tones.end(), 0.6F);  // the lights go on
  const std::vector<Exposure> exposures = auto_expose(tones, 0.1);
  EXPECT_NEAR(0.2F * std::sqrt(exposures[29].gain), 0.5F, 0.02F);
  EXPECT_GT(0.6F * std::sqrt(exposures[30].gain), 0.9F);
  EXPECT_NEAR(0.6F * std::sqrt(exposures[45].gain), 0.5F, 0.03F);
  EXPECT_GT(exposures[0].time_s, exposures[59].time_s);
}

/// Sum of absolute grey differences between neighbours, along rows or down columns.
double roughness(const Image<std::uint8_t>& image, int dx, int dy) {
  double sum = 0;
  for (int y = 0; y + dy < image.height; ++y) {
    for (int x = 0; x + dx < image.width; ++x) sum += std::abs(image.at(x + dx, y + dy) - image.at(x, y));
  }
  return sum;
}

TEST(ColorSensor, TurningBlursAlongTheRows) {
  const Scene scene = wall_at(2.0, Material::kBrick);
  const Intrinsics camera = simulated_camera().color;
  Renderer renderer(scene, camera);
  const Rendering& rendering = renderer.render(looking_along_x(), {});
  ColorSensor sensor(camera);
  Image<std::uint8_t> still, turning;
  const Exposure exposure{2.0F, 0.02F};
  sensor.expose(rendering, {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()}, exposure, 1, false, &still);
  sensor.expose(rendering, {Eigen::Vector3d::Zero(), Eigen::Vector3d(0, 1.0, 0)}, exposure, 1, false, &turning);
  EXPECT_LT(roughness(turning, 1, 0), 0.8 * roughness(still, 1, 0));
  EXPECT_GT(roughness(turning, 0, 1), 0.85 * roughness(still, 0, 1));
}

}  // namespace
}  // namespace camloc::sim
