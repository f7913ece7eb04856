// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapmaking/landmark_fusion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/features/hamming.h"
#include "tests/mapmaking/generated_view.h"

namespace camloc {
namespace {

struct Point {
  Eigen::Vector3d p_map;
  Descriptor descriptor;
};

/// Points in front of a camera at the origin, each with an appearance of its own.
std::vector<Point> random_points(int count, std::mt19937_64& random) {
  std::uniform_real_distribution<double> x(-0.9, 0.9), y(-0.6, 0.6), z(1.8, 3.0);
  std::vector<Point> points;
  for (int i = 0; i < count; ++i) points.push_back({{x(random), y(random), z(random)}, {{random(), random(), random(), random()}}});
  return points;
}

/// All points as the camera sees them, with noise of pixel and depth and a few flipped bits.
FrameFeatures see(const std::vector<Point>& points, const Rigid3& T_map_camera, double noise, std::mt19937_64& random) {
  const Intrinsics k = test_intrinsics();
  std::normal_distribution<double> normal(0, noise);
  FrameFeatures view;
  view.T_map_camera = T_map_camera;
  for (const Point& point : points) {
    const Eigen::Vector3d p = T_map_camera.inverse() * point.p_map;
    const Eigen::Vector2d pixel = k.project(p) + 0.5 * Eigen::Vector2d(normal(random), normal(random));
    if (pixel.x() < 0 || pixel.y() < 0 || pixel.x() > 639 || pixel.y() > 479) continue;
    add_feature(k, pixel, p.z() + DepthNoise{}.sigma_m(p.z()) * normal(random), 0, flipped(point.descriptor, 8, random), &view);
  }
  return view;
}

TEST(LandmarkFusion, OnePointIsOneLandmark) {
  std::mt19937_64 random(11);
  const auto points = random_points(200, random);
  LandmarkFusion fusion(test_intrinsics(), {}, {});
  constexpr int kViews = 12;
  for (int i = 0; i < kViews; ++i) fusion.add_view(see(points, pose(0.04 * i - 0.2, 0.01 * i, 0.01 * i), 1.0, random));
  // A few depth errors beyond three sigma may start another landmark.
  EXPECT_GE(fusion.num_landmarks(), 200U);
  EXPECT_LE(fusion.num_landmarks(), 206U);
  std::vector<std::vector<std::uint32_t>> support;
  const auto landmarks = fusion.landmarks(&support);
  double sum_squared = 0, expected = 0;
  int count = 0;
  for (const Point& point : points) {
    const auto nearest = std::min_element(landmarks.begin(), landmarks.end(), [&](const MapLandmark& a, const MapLandmark& b) {
      return (a.position_m.cast<double>() - point.p_map).norm() < (b.position_m.cast<double>() - point.p_map).norm();
    });
    if (nearest->num_observations < 8) continue;
    sum_squared += (nearest->position_m.cast<double>() - point.p_map).squaredNorm();
    expected += std::pow(DepthNoise{}.sigma_m(point.p_map.z()), 2) / nearest->num_observations;
    EXPECT_LE(hamming_distance(nearest->descriptors[0], point.descriptor), 16);
    EXPECT_EQ(nearest->descriptors.size(), 1U);
    ++count;
  }
  EXPECT_GE(count, 190);
  // The error of the mean is what averaging the depth noise leaves, a little more for the pixels.
  EXPECT_LT(sum_squared, 1.6 * expected);
}

TEST(LandmarkFusion, NeverFusesAcrossADepthDisagreement) {
  std::mt19937_64 random(13);
  const Point point{{0, 0, 2}, {{random(), random(), random(), random()}}};
  LandmarkFusion fusion(test_intrinsics(), {}, {});
  const Intrinsics k = test_intrinsics();
  for (const double depth : {2.0, 2.05, 2.3}) {  // sigma at 2 m is 2.5 cm
    FrameFeatures view;
    add_feature(k, {320, 240}, depth, 0, point.descriptor, &view);
    fusion.add_view(view);
  }
  EXPECT_EQ(fusion.num_landmarks(), 2U);
  std::vector<std::vector<std::uint32_t>> support;
  EXPECT_EQ(fusion.landmarks(&support)[0].num_observations, 2U);
}

TEST(LandmarkFusion, UnlikeFeaturesStayApart) {
  std::mt19937_64 random(14);
  LandmarkFusion fusion(test_intrinsics(), {}, {});
  for (int i = 0; i < 2; ++i) {
    FrameFeatures view;
    add_feature(test_intrinsics(), {320, 240}, 2, 0, {{random(), random(), random(), random()}}, &view);
    fusion.add_view(view);
  }
  EXPECT_EQ(fusion.num_landmarks(), 2U);
}

TEST(LandmarkFusion, SameCornerOnOtherLevelsIsOneLandmark) {
  std::mt19937_64 random(15);
  const Descriptor descriptor{{random(), random(), random(), random()}};
  LandmarkFusion fusion(test_intrinsics(), {}, {});
  for (int i = 0; i < 2; ++i) {
    FrameFeatures view;
    for (int level = 0; level < 3; ++level)
      add_feature(test_intrinsics(), {320 + 0.4 * level, 240}, 2, level, flipped(descriptor, 10, random), &view);
    fusion.add_view(view);
  }
  EXPECT_EQ(fusion.num_landmarks(), 1U);
  EXPECT_EQ(fusion.num_observations(), 2U);  // one a view: the other two levels were absorbed
  std::vector<std::vector<std::uint32_t>> support;
  EXPECT_NEAR(fusion.landmarks(&support)[0].max_reference_m, 2 * 1.44, 1e-2);
}

TEST(LandmarkFusion, ViewsListTheirLandmarksOnce) {
  std::mt19937_64 random(17);
  const auto points = random_points(150, random);
  LandmarkFusion fusion(test_intrinsics(), {}, {});
  for (int i = 0; i < 6; ++i) fusion.add_view(see(points, pose(0.05 * i, 0, 0), 1.0, random));
  ASSERT_EQ(fusion.views().size(), 6U);
  std::uint64_t observations = 0;
  for (const auto& view : fusion.views()) {
    std::vector<std::uint32_t> seen;
    for (const auto& o : view) {
      EXPECT_LT(o.landmark, fusion.num_landmarks());
      EXPECT_LT(o.cell, kNumCells);
      seen.push_back(o.landmark);
    }
    std::sort(seen.begin(), seen.end());
    EXPECT_EQ(std::adjacent_find(seen.begin(), seen.end()), seen.end());
    observations += view.size();
  }
  EXPECT_EQ(observations, fusion.num_observations());
}

TEST(LandmarkFusion, FeaturesWithoutDepthAddNothing) {
  LandmarkFusion fusion(test_intrinsics(), {}, {});
  FrameFeatures view;
  add_feature(test_intrinsics(), {320, 240}, 0, 0, {}, &view);
  fusion.add_view(view);
  fusion.add_view({});
  EXPECT_EQ(fusion.num_landmarks(), 0U);
  EXPECT_EQ(fusion.views().size(), 2U);
}

}  // namespace
}  // namespace camloc
