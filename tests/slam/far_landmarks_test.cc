// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Features without depth that two keyframes see.
#include <gtest/gtest.h>

#include "core/slam/keyframe_insertion.h"
#include "tests/geometry/generated.h"
#include "tests/slam/true_keyframes.h"

namespace camloc {
namespace {

using testing::looking;
using testing::TrueKeyframes;

TEST(FarLandmarks, AreWhereTheyAre) {
  TrueKeyframes f(testing::make_hall());
  f.add(looking({0, 0, 1.5}, 0));
  f.add(looking({0.5, 0.1, 1.5}, 0.02));
  const std::uint32_t third = f.add(looking({1.0, -0.1, 1.5}, -0.02));
  const std::uint32_t num_before = f.map.num_alive_landmarks();
  const int num_added = add_far_landmarks({}, third, &f.map);
  EXPECT_GE(num_added, 40);
  EXPECT_EQ(f.map.num_alive_landmarks(), num_before + static_cast<std::uint32_t>(num_added));
  int num_wrong = 0;
  for (std::uint32_t i = num_before; i < f.map.landmarks().size(); ++i) {
    const SlamLandmark& landmark = f.map.landmark(i);
    ASSERT_EQ(landmark.observations.size(), 2U);
    EXPECT_EQ(f.map.keyframe(third).landmark_of_feature[landmark.observations[1].feature], static_cast<std::int32_t>(i));
    for (const Observation& s : landmark.observations) EXPECT_EQ(f.map.keyframe(s.keyframe).view.depth_m[s.feature], 0);
    if (!f.is_one_point(landmark)) {
      ++num_wrong;
      continue;
    }
    // A pixel of error over a baseline of half a metre: the distance is off by z^2 / (f b) a pixel, times what the ray is off axis.
    const Eigen::Vector3d truth = f.world.points[f.point(landmark.observations[0])].position_m;
    const double distance = (truth - f.map.keyframe(third).view.T_map_camera.translation).norm();
    EXPECT_LT((landmark.position_m - truth).norm(), 0.05 + 0.4 * distance);
  }
  EXPECT_LE(num_wrong, num_added / 20);
}

TEST(FarLandmarks, NeedABaselineAndTheSameSegment) {
  TrueKeyframes f(testing::make_hall());
  f.add(looking({0, 0, 1.5}, 0));
  EXPECT_EQ(add_far_landmarks({}, f.add(looking({0.05, 0, 1.5}, 0)), &f.map), 0);
  EXPECT_EQ(add_far_landmarks({}, f.add(looking({0.8, 0, 1.5}, 0), 1), &f.map), 0);
  EXPECT_EQ(add_far_landmarks({}, f.add(looking({0.8, 0, 1.5}, 1.5), 1), &f.map), 0);  // looks elsewhere
  EXPECT_EQ(add_far_landmarks({}, 0, &f.map), 0);
}

TEST(Triangulate, FindsThePoint) {
  std::mt19937 rng(4);
  for (int i = 0; i < 100; ++i) {
    const Rigid3 a = testing::random_pose(rng, 1.0);
    const Rigid3 b{a.rotation * exp_so3(testing::random_vector(rng, 0.1)), a.translation + a.rotation * Eigen::Vector3d(0.4, 0.1, 0.05)};
    const Eigen::Vector3d p = a * Eigen::Vector3d(0.3, -0.5, 5);
    const Eigen::Vector3d in_a = a.inverse() * p, in_b = b.inverse() * p;
    const auto found = triangulate(a, in_a.head<2>() / in_a.z(), b, in_b.head<2>() / in_b.z());
    ASSERT_TRUE(found.has_value());
    EXPECT_LT((*found - p).norm(), 1e-6);
  }
}

TEST(Triangulate, RefusesWhatIsBehindAndParallel) {
  const Rigid3 a, b{Eigen::Quaterniond::Identity(), {1, 0, 0}};
  EXPECT_FALSE(triangulate(a, {0, 0}, b, {0, 0}).has_value());       // meet nowhere
  EXPECT_FALSE(triangulate(a, {-0.1, 0}, b, {0.1, 0}).has_value());  // meet behind
  EXPECT_FALSE(triangulate(a, {0.1, 0}, a, {0.1, 0}).has_value());
}

}  // namespace
}  // namespace camloc
