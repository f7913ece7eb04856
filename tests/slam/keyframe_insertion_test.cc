// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Keyframes at true poses in a generated room: what becomes a landmark, what becomes one landmark.
#include "core/slam/keyframe_insertion.h"

#include <gtest/gtest.h>

#include "tests/slam/true_keyframes.h"

namespace camloc {
namespace {

using testing::looking;
using testing::TrueKeyframes;

TEST(KeyframeInsertion, FeaturesWithDepthBecomeLandmarks) {
  TrueKeyframes f(testing::make_room());
  f.add(looking({0, 0, 1.4}, 0));
  const SlamKeyframe& keyframe = f.map.keyframe(0);
  for (std::uint32_t i = 0; i < keyframe.view.size(); ++i)
    EXPECT_EQ(keyframe.landmark_of_feature[i] != kNoLandmark, keyframe.view.depth_m[i] > 0);
  EXPECT_EQ(keyframe.num_landmarks, f.map.num_alive_landmarks());
}

TEST(KeyframeInsertion, TrackedLandmarksAreSeenAgainInsteadOfMadeAnew) {
  TrueKeyframes f(testing::make_room());
  f.add(looking({0, 0, 1.4}, 0));
  const Rigid3 T = looking({0.05, 0, 1.4}, 0.03);
  FrameFeatures view = f.viewer.see(1, T);
  view.T_map_camera = T;
  LandmarkSet set = f.map.empty_landmark_set();
  const std::uint32_t first = 0;
  f.map.collect_landmarks({&first, 1}, 1000, &set);
  const Registration found = register_near(view, T, 10, 1, &set, &f.solver);
  ASSERT_TRUE(found.is_found);
  const std::uint32_t num_before = f.map.num_alive_landmarks();
  const std::uint32_t keyframe = insert_keyframe(1, 0, view, found.inliers, &f.map);
  const auto shared = f.map.covisible(keyframe, 1);
  ASSERT_EQ(shared.size(), 1U);
  EXPECT_EQ(shared[0].num_shared, found.inliers.size());
  EXPECT_EQ(f.map.num_alive_landmarks() - num_before, f.map.keyframe(keyframe).num_landmarks - found.inliers.size());
}

TEST(KeyframeInsertion, FusingMakesOneLandmarkOfOnePoint) {
  TrueKeyframes f(testing::make_room());
  f.add(looking({0, 0, 1.4}, 0));
  const std::uint32_t second = f.add(looking({0.1, 0.05, 1.4}, 0.05));
  LandmarkSet set = f.map.empty_landmark_set();
  const std::uint32_t first = 0;
  f.map.collect_landmarks({&first, 1}, 1000, &set);
  const std::uint32_t num_before = f.map.num_alive_landmarks();
  const int num_fused = fuse_into_keyframe(&set, second, 4, &f.solver, &f.map);
  EXPECT_GE(num_fused, 150);
  EXPECT_LT(f.map.num_alive_landmarks(), num_before - 100);
  std::size_t num_shared = 0, num_wrong = 0;
  for (const SlamLandmark& landmark : f.map.landmarks()) {
    if (landmark.observations.size() < 2) continue;
    ++num_shared;
    num_wrong += f.is_one_point(landmark) ? 0U : 1U;
  }
  EXPECT_EQ(num_shared, static_cast<std::size_t>(num_fused));
  EXPECT_LE(num_wrong, num_shared / 50);
  // Asked again there is nothing left to do.
  f.map.collect_landmarks({&first, 1}, 1000, &set);
  EXPECT_LE(fuse_into_keyframe(&set, second, 4, &f.solver, &f.map), num_fused / 20);
}

TEST(KeyframeInsertion, WhatLiesAtAnotherDepthIsNotFused) {
  TrueKeyframes f(testing::make_room());
  f.add(looking({0, 0, 1.4}, 0));
  const Rigid3 T = looking({0.02, 0, 1.4}, 0.01);
  FrameFeatures view = f.viewer.see(1, T);
  view.T_map_camera = T;
  for (float& z : view.depth_m) z *= 0.8F;
  const std::uint32_t second = insert_keyframe(1, 0, view, {}, &f.map);
  LandmarkSet set = f.map.empty_landmark_set();
  const std::uint32_t first = 0;
  f.map.collect_landmarks({&first, 1}, 1000, &set);
  std::size_t num_holes = 0;
  for (const float z : view.depth_m) num_holes += z > 0 ? 0U : 1U;
  EXPECT_LE(fuse_into_keyframe(&set, second, 4, &f.solver, &f.map), static_cast<int>(num_holes));
}

}  // namespace
}  // namespace camloc
