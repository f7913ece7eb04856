// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A textured wall seen by cameras at known poses, with features a pixel off: refined observations must be of one point again.
#include "core/slam/observation_refinement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "tests/dense/generated_texture.h"

namespace camloc {
namespace {

constexpr double kTextureUnit = 0.005;  // metres: one pixel of level 0 from 2.6 m away

/// The wall is the plane z = 0; cameras look along +z from below.
class TexturedWall {
 public:
  TexturedWall() {
    camera_.color.width = 640;
    camera_.color.height = 480;
    camera_.color.fx = camera_.color.fy = 525;
    camera_.color.cx = 319.5;
    camera_.color.cy = 239.5;
    camera_.depth = camera_.color;
  }

  [[nodiscard]] const RgbdCamera& camera() const { return camera_; }

  /// Where the wall is seen in that direction, in the map.
  [[nodiscard]] static Eigen::Vector3d hit(const Rigid3& T_map_camera, const Eigen::Vector2d& normalized) {
    const Eigen::Vector3d ray = T_map_camera.rotation * normalized.homogeneous();
    return T_map_camera.translation - T_map_camera.translation.z() / ray.z() * ray;
  }

  /// One feature a point, off by up to `error_px` pixels of its level.
  FrameFeatures see(const Rigid3& T_map_camera, const std::vector<Eigen::Vector3d>& points, std::uint8_t level, double error_px,
                    std::mt19937_64* rng) const {
    std::uniform_real_distribution<double> error(-error_px, error_px);
    const double scale = std::pow(1.2, level);
    FrameFeatures view;
    view.T_map_camera = T_map_camera;
    for (const Eigen::Vector3d& point : points) {
      const Eigen::Vector2d pixel =
          camera_.color.project(T_map_camera.inverse() * point) + scale * Eigen::Vector2d(error(*rng), error(*rng));
      const Eigen::Vector2d normalized = camera_.color.undistort(pixel);
      view.features.keypoints.push_back({static_cast<float>(pixel.x()), static_cast<float>(pixel.y()), 0, 1, level});
      view.features.descriptors.push_back({{(*rng)(), (*rng)(), (*rng)(), (*rng)()}});
      view.normalized.push_back(normalized.cast<float>());
      view.depth_m.push_back(static_cast<float>((T_map_camera.inverse() * hit(T_map_camera, normalized)).z()));
      FeaturePatch& patch = view.patches.emplace_back();
      for (int dy = -FeaturePatch::kHalf; dy <= FeaturePatch::kHalf; ++dy) {
        for (int dx = -FeaturePatch::kHalf; dx <= FeaturePatch::kHalf; ++dx) {
          const Eigen::Vector3d on_wall = hit(T_map_camera, camera_.color.undistort(pixel + scale * Eigen::Vector2d(dx, dy)));
          patch.pixels[static_cast<std::size_t>((dy + FeaturePatch::kHalf) * FeaturePatch::kSide + dx + FeaturePatch::kHalf)] =
              static_cast<std::uint8_t>(std::lround(128 + std::clamp(texture_.at(on_wall.head<2>() / kTextureUnit), -120.0, 120.0)));
        }
      }
    }
    return view;
  }

 private:
  RgbdCamera camera_;
  testing::Texture texture_{11};
};

Rigid3 standing_at(double x, double y, double z, double turn_rad) {
  return {exp_so3({0.3 * turn_rad, turn_rad, 0.5 * turn_rad}), {x, y, z}};
}

/// How far apart the places on the wall are that the observations of a landmark show, in pixels of level 0; median over landmarks.
double spread_px(const SlamMap& map, const std::vector<Rigid3>& T_map_camera_true) {
  std::vector<double> spreads;
  for (const SlamLandmark& landmark : map.landmarks()) {
    double sum = 0;
    Eigen::Vector3d first = Eigen::Vector3d::Zero();
    for (const Observation& s : landmark.observations) {
      const Eigen::Vector3d place =
          TexturedWall::hit(T_map_camera_true[s.keyframe], map.keyframe(s.keyframe).view.normalized[s.feature].cast<double>());
      if (&s == &landmark.observations.front()) first = place;
      sum += (place - first).norm() / kTextureUnit;
    }
    spreads.push_back(sum / static_cast<double>(landmark.observations.size() - 1));
  }
  std::nth_element(spreads.begin(), spreads.begin() + static_cast<std::ptrdiff_t>(spreads.size() / 2), spreads.end());
  return spreads[spreads.size() / 2];
}

/// The wall with its views; what the map believes about poses and distances is a little off.
struct Scene {
  TexturedWall wall;
  std::vector<Rigid3> T_map_camera_true;
  SlamMap map{wall.camera(), 1.2F, 8};

  explicit Scene(bool has_patches = true) {
    std::mt19937_64 rng(7);
    std::uniform_real_distribution<double> place(-0.6, 0.6), off(-0.01, 0.01);
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < 150; ++i) points.emplace_back(place(rng), place(rng), 0);
    const struct {
      double x, y, z, turn_rad;
      std::uint8_t level;
    } stands[] = {{0, 0, -2.6, 0, 0}, {0.3, 0.1, -2.5, -0.1, 0}, {-0.3, 0.2, -2.2, 0.12, 1}, {0.1, -0.3, -3.0, 0.05, 0}};
    for (const auto& stand : stands) {
      const Rigid3 T = standing_at(stand.x, stand.y, stand.z, stand.turn_rad);
      FrameFeatures view = wall.see(T, points, stand.level, 0.7, &rng);
      view.T_map_camera.translation += Eigen::Vector3d(off(rng), off(rng), off(rng));
      if (!has_patches) view.patches.clear();
      T_map_camera_true.push_back(T);
      const std::uint32_t keyframe = map.add_keyframe(T_map_camera_true.size() - 1, 0, std::move(view));
      for (std::uint32_t i = 0; i < points.size(); ++i) {
        if (keyframe == 0)
          map.add_landmark({0, i});
        else
          map.add_observation(i, {keyframe, i});
      }
    }
    for (std::uint32_t i = 0; i < points.size(); ++i) map.summarize(i);
  }
};

TEST(ObservationRefinement, ObservationsBecomeOnePoint) {
  Scene scene;
  const double before = spread_px(scene.map, scene.T_map_camera_true);
  const std::uint64_t num_aligned = refine_observations(&scene.map);
  const double after = spread_px(scene.map, scene.T_map_camera_true);
  EXPECT_GT(num_aligned, 350U);  // of 450
  EXPECT_GT(before, 0.5);
  EXPECT_LT(after, 0.2 * before);
}

TEST(ObservationRefinement, DoingItAgainChangesNothing) {
  Scene scene;
  (void)refine_observations(&scene.map);
  const SlamMap once = scene.map;
  (void)refine_observations(&scene.map);
  for (std::uint32_t k = 0; k < once.keyframes().size(); ++k)
    EXPECT_EQ(once.keyframe(k).view.normalized, scene.map.keyframe(k).view.normalized);
}

TEST(ObservationRefinement, WithoutPatchesEverythingStays) {
  Scene scene(false);
  const SlamMap before = scene.map;
  EXPECT_EQ(refine_observations(&scene.map), 0U);
  for (std::uint32_t k = 0; k < before.keyframes().size(); ++k)
    EXPECT_EQ(before.keyframe(k).view.normalized, scene.map.keyframe(k).view.normalized);
}

}  // namespace
}  // namespace camloc
