// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/evaluation/epipolar_error.h"

#include <gtest/gtest.h>

#include <random>

namespace camloc::tools {
namespace {

constexpr double kFocal = 525;

Intrinsics color() {
  Intrinsics k;
  k.width = 640;
  k.height = 480;
  k.fx = k.fy = kFocal;
  k.cx = 319.5;
  k.cy = 239.5;
  return k;
}

struct Point {
  Eigen::Vector3d p;
  Descriptor descriptor;
};

std::vector<Point> make_points(int count) {
  std::mt19937_64 rng(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Point> points;
  for (int i = 0; i < count; ++i)
    points.push_back({{0.8 * uniform(rng), 0.6 * uniform(rng), 2.2 + uniform(rng)}, {{rng(), rng(), rng(), rng()}}});
  return points;
}

/// What a camera sees of the points; it believes to be at `believed`.
FrameFeatures see(const std::vector<Point>& points, const Rigid3& truth, const Rigid3& believed, double noise_px, std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  std::normal_distribution<double> noise(0, noise_px / kFocal);
  FrameFeatures view;
  view.T_map_camera = believed;
  for (const Point& point : points) {
    const Eigen::Vector3d p = truth.inverse() * point.p;
    Keypoint keypoint;
    keypoint.u = static_cast<float>(kFocal * p.x() / p.z() + 319.5);
    keypoint.v = static_cast<float>(kFocal * p.y() / p.z() + 239.5);
    view.features.keypoints.push_back(keypoint);
    view.features.descriptors.push_back(point.descriptor);
    view.normalized.emplace_back(static_cast<float>(p.x() / p.z() + noise(rng)), static_cast<float>(p.y() / p.z() + noise(rng)));
    view.depth_m.push_back(static_cast<float>(p.z()));
  }
  return view;
}

const Rigid3 kA, kB{exp_so3({0.02, -0.1, 0.03}), {0.3, 0.05, -0.1}};

TEST(EpipolarError, RightPosesLeaveTheNoiseOfTheFeatures) {
  const auto points = make_points(300);
  EpipolarMeter meter(color(), {});
  const auto error = meter.measure(see(points, kA, kA, 0.5, 1), see(points, kB, kB, 0.5, 2));
  ASSERT_TRUE(error);
  EXPECT_GE(error->num_matches, 290);
  EXPECT_LT(error->median_px, 0.5);
  EXPECT_GT(error->median_px, 0.1);
}

TEST(EpipolarError, WrongPosesAreJudgedAndNotBelieved) {
  const auto points = make_points(300);
  EpipolarMeter meter(color(), {});
  const Rigid3 turned{kB.rotation * exp_so3({0.01, 0, 0}), kB.translation},
      shifted{kB.rotation, kB.translation + Eigen::Vector3d(0, 0.03, 0)};
  for (const Rigid3& believed : {turned, shifted}) {
    const auto error = meter.measure(see(points, kA, kA, 0, 1), see(points, kB, believed, 0, 2));
    ASSERT_TRUE(error);
    EXPECT_GE(error->num_matches, 290);
    EXPECT_GT(error->median_px, 1.0);
  }
}

TEST(EpipolarError, ViewsThatShareTooLittleSayNothing) {
  const auto points = make_points(300);
  const std::vector<Point> few(points.begin(), points.begin() + 30);
  EpipolarMeter meter(color(), {});
  EXPECT_FALSE(meter.measure(see(points, kA, kA, 0, 1), see(few, kB, kB, 0, 2)));
  EXPECT_FALSE(meter.measure(FrameFeatures{}, see(points, kB, kB, 0, 2)));
}

TEST(EpipolarError, TheSampsonDistanceIsThatOfTheMatchWhereTheLineIsKnown) {
  const Rigid3 T_b_a{Eigen::Quaterniond::Identity(), {0.2, 0, 0}};  // epipolar lines are rows
  EXPECT_NEAR(sampson_distance(T_b_a, {0.1, 0.05}, {0.2, 0.05}), 0, 1e-12);
  EXPECT_NEAR(sampson_distance(T_b_a, {0.1, 0.05}, {0.2, 0.07}), 0.02 / std::sqrt(2.0), 1e-12);
}

TEST(EpipolarError, TheMostSimilarViewsAreNearAndLookTheSameWay) {
  const Rigid3 near{exp_so3({0, 0.05, 0}), {0.1, 0, 0}}, turned{exp_so3({0, 1.0, 0}), {0, 0, 0}},
      far{Eigen::Quaterniond::Identity(), {1, 0, 0}};
  const std::vector<Rigid3> others{turned, far, near};
  EXPECT_EQ(most_similar_views(kA, others, {false, false, false}, 2), (std::vector<std::size_t>{2, 1}));
  EXPECT_EQ(most_similar_views(kA, others, {false, false, true}, 5), (std::vector<std::size_t>{1, 0}));
}

}  // namespace
}  // namespace camloc::tools
