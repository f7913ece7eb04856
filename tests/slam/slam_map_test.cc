// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Who saw what must agree in both directions, whatever happens to the map.
#include "core/slam/slam_map.h"

#include <gtest/gtest.h>

#include <random>

#include "core/features/hamming.h"

namespace camloc {
namespace {

RgbdCamera test_camera() {
  RgbdCamera camera;
  camera.color.width = 640;
  camera.color.height = 480;
  camera.color.fx = camera.color.fy = 500;
  camera.color.cx = 320;
  camera.color.cy = 240;
  camera.depth = camera.color;
  return camera;
}

/// Features on a grid, all at the given depth.
FrameFeatures grid_view(std::size_t count, float depth_m, std::mt19937_64* rng) {
  FrameFeatures view;
  for (std::size_t i = 0; i < count; ++i) {
    const auto x = static_cast<float>(i % 10) * 0.05F - 0.25F, y = static_cast<float>(i / 10) * 0.05F - 0.25F;
    view.features.keypoints.push_back({320 + 500 * x, 240 + 500 * y, 0, 1, static_cast<std::uint8_t>(i % 3)});
    view.features.descriptors.push_back({{(*rng)(), (*rng)(), (*rng)(), (*rng)()}});
    view.normalized.emplace_back(x, y);
    view.depth_m.push_back(depth_m);
  }
  return view;
}

void expect_consistent(const SlamMap& map) {
  std::uint32_t num_alive = 0;
  for (std::uint32_t i = 0; i < map.landmarks().size(); ++i) {
    const SlamLandmark& landmark = map.landmark(i);
    num_alive += landmark.is_alive() ? 1U : 0U;
    EXPECT_TRUE(landmark.merged_into == kNoLandmark || !landmark.is_alive());
    for (std::size_t s = 0; s < landmark.observations.size(); ++s) {
      const Observation& observation = landmark.observations[s];
      EXPECT_TRUE(s == 0 || landmark.observations[s - 1].keyframe < observation.keyframe);
      ASSERT_LT(observation.keyframe, map.keyframes().size());
      ASSERT_EQ(map.keyframe(observation.keyframe).landmark_of_feature[observation.feature], static_cast<std::int32_t>(i));
    }
  }
  EXPECT_EQ(num_alive, map.num_alive_landmarks());
  for (std::uint32_t k = 0; k < map.keyframes().size(); ++k) {
    const SlamKeyframe& keyframe = map.keyframe(k);
    std::uint32_t num_landmarks = 0;
    for (std::uint32_t f = 0; f < keyframe.landmark_of_feature.size(); ++f) {
      if (keyframe.landmark_of_feature[f] == kNoLandmark) continue;
      ++num_landmarks;
      const auto& observations = map.landmark(static_cast<std::uint32_t>(keyframe.landmark_of_feature[f])).observations;
      EXPECT_EQ(
          std::count_if(observations.begin(), observations.end(), [&](const Observation& s) { return s.keyframe == k && s.feature == f; }),
          1);
    }
    EXPECT_EQ(num_landmarks, keyframe.num_landmarks);
  }
}

TEST(SlamMap, ALandmarkLiesWhereItsKeyframeSeesIt) {
  std::mt19937_64 rng(1);
  SlamMap map(test_camera(), 1.2F, 8);
  FrameFeatures view = grid_view(30, 2.0F, &rng);
  view.T_map_camera = {exp_so3({0.1, 0.2, 0.3}), {1, 2, 3}};
  const std::uint32_t keyframe = map.add_keyframe(7, 0, view);
  const std::uint32_t index = map.add_landmark({keyframe, 14});
  const SlamLandmark& landmark = map.landmark(index);
  EXPECT_LT((landmark.position_m - view.T_map_camera * view.point_camera(14)).norm(), 1e-12);
  EXPECT_EQ(landmark.descriptor, view.features.descriptors[14]);
  EXPECT_EQ(map.keyframe(keyframe).frame, 7U);
  // Towards the camera; at its distance on the level it was seen on.
  const Eigen::Vector3d to_camera = view.T_map_camera.translation - landmark.position_m;
  EXPECT_NEAR(landmark.direction.dot(to_camera.normalized()), 1, 1e-12);
  EXPECT_NEAR(landmark.min_reference_m, to_camera.norm() * std::pow(1.2, 14 % 3), 1e-4);
  EXPECT_EQ(landmark.min_reference_m, landmark.max_reference_m);
  expect_consistent(map);
}

TEST(SlamMap, AFeatureShowsOneLandmarkAndAKeyframeSeesItOnce) {
  std::mt19937_64 rng(1);
  SlamMap map(test_camera(), 1.2F, 8);
  const std::uint32_t k0 = map.add_keyframe(0, 0, grid_view(20, 2.0F, &rng)), k1 = map.add_keyframe(1, 0, grid_view(20, 2.0F, &rng));
  const std::uint32_t a = map.add_landmark({k0, 3}), b = map.add_landmark({k0, 4});
  map.add_observation(a, {k0, 5});  // seen already
  map.add_observation(b, {k1, 6});
  map.add_observation(a, {k1, 6});  // taken
  EXPECT_EQ(map.landmark(a).observations.size(), 1U);
  EXPECT_EQ(map.landmark(b).observations.size(), 2U);
  map.remove_observation(a, k1);  // never saw it
  EXPECT_EQ(map.num_alive_landmarks(), 2U);
  map.remove_observation(a, k0);
  EXPECT_EQ(map.num_alive_landmarks(), 1U);
  EXPECT_EQ(map.resolve(a), kNoLandmark);
  EXPECT_EQ(map.resolve(b), static_cast<std::int32_t>(b));
  expect_consistent(map);
}

TEST(SlamMap, MergingKeepsTheObservationsOfTheOneThatStays) {
  std::mt19937_64 rng(1);
  SlamMap map(test_camera(), 1.2F, 8);
  for (int k = 0; k < 3; ++k) map.add_keyframe(static_cast<std::uint64_t>(k), 0, grid_view(20, 2.0F, &rng));
  const std::uint32_t a = map.add_landmark({0, 1}), b = map.add_landmark({1, 2}), c = map.add_landmark({2, 9});
  map.add_observation(a, {1, 3});
  map.add_observation(b, {2, 4});
  map.merge(b, a);
  ASSERT_EQ(map.landmark(a).observations.size(), 3U);
  EXPECT_EQ(map.landmark(a).observations[1].feature, 3U);  // its own in keyframe 1
  EXPECT_EQ(map.landmark(a).observations[2].feature, 4U);  // the other's in keyframe 2
  EXPECT_EQ(map.keyframe(1).landmark_of_feature[2], kNoLandmark);
  EXPECT_EQ(map.resolve(b), static_cast<std::int32_t>(a));
  map.merge(a, c);
  EXPECT_EQ(map.resolve(b), static_cast<std::int32_t>(c));
  map.merge(c, c);
  EXPECT_EQ(map.resolve(c), static_cast<std::int32_t>(c));
  expect_consistent(map);
}

TEST(SlamMap, StaysConsistentUnderRandomOperations) {
  std::mt19937_64 rng(99);
  const auto below = [&](std::size_t limit) { return static_cast<std::uint32_t>(rng() % limit); };
  SlamMap map(test_camera(), 1.2F, 8);
  for (int step = 0; step < 6000; ++step) {
    const std::uint32_t what = below(20);
    if (map.keyframes().size() < 3 || (what == 0 && map.keyframes().size() < 25)) {
      map.add_keyframe(static_cast<std::uint64_t>(step), 0, grid_view(60, 2.0F, &rng));
      continue;
    }
    const Observation s{below(map.keyframes().size()), below(60)};
    if (what < 6 || map.landmarks().empty()) {
      if (map.keyframe(s.keyframe).landmark_of_feature[s.feature] == kNoLandmark) map.add_landmark(s);
      continue;
    }
    const std::int32_t landmark = map.resolve(below(map.landmarks().size())), other = map.resolve(below(map.landmarks().size()));
    if (landmark == kNoLandmark || other == kNoLandmark) continue;
    if (what < 12)
      map.add_observation(static_cast<std::uint32_t>(landmark), s);
    else if (what < 16)
      map.remove_observation(static_cast<std::uint32_t>(landmark), s.keyframe);
    else
      map.merge(static_cast<std::uint32_t>(landmark), static_cast<std::uint32_t>(other));
    if (step % 200 == 0) expect_consistent(map);
  }
  expect_consistent(map);
  EXPECT_GT(map.num_alive_landmarks(), 50U);
  EXPECT_LT(map.num_alive_landmarks(), map.landmarks().size());
  // Whatever a landmark has become is one that is there, and nothing goes round in circles.
  for (std::uint32_t i = 0; i < map.landmarks().size(); ++i) {
    const std::int32_t now = map.resolve(i);
    EXPECT_TRUE(now == kNoLandmark || map.landmark(static_cast<std::uint32_t>(now)).is_alive());
  }
}

TEST(SlamMap, CovisibleCountsSharedLandmarksAndOrdersThem) {
  std::mt19937_64 rng(1);
  SlamMap map(test_camera(), 1.2F, 8);
  for (int k = 0; k < 5; ++k) map.add_keyframe(static_cast<std::uint64_t>(k), 0, grid_view(50, 2.0F, &rng));
  const std::uint32_t shared[] = {0, 10, 30, 10, 2};  // of keyframe 0 with the others
  for (std::uint32_t f = 0; f < 50; ++f) {
    const std::uint32_t landmark = map.add_landmark({0, f});
    for (std::uint32_t k = 1; k < 5; ++k) {
      if (f < shared[k]) map.add_observation(landmark, {k, f});
    }
  }
  const auto all = map.covisible(0, 1);
  ASSERT_EQ(all.size(), 4U);
  EXPECT_EQ(all[0].keyframe, 2U);
  EXPECT_EQ(all[0].num_shared, 30U);
  EXPECT_EQ(all[1].keyframe, 1U);
  EXPECT_EQ(all[2].keyframe, 3U);
  EXPECT_EQ(all[3].num_shared, 2U);
  EXPECT_EQ(map.covisible(0, 10).size(), 3U);
  EXPECT_EQ(map.covisible(0, 31).size(), 0U);
}

TEST(SlamMap, TheDescriptorIsTheOneClosestToAllOthers) {
  std::mt19937_64 rng(1);
  SlamMap map(test_camera(), 1.2F, 8);
  FrameFeatures view = grid_view(1, 2.0F, &rng);
  const Descriptor middle = view.features.descriptors[0];
  const auto changed = [&](std::uint64_t mask, std::size_t word) {
    Descriptor d = middle;
    d.bits[word] ^= mask;
    return d;
  };
  for (const Descriptor& d : {changed(0xFF, 0), changed(0xFF, 1), middle, changed(0xFF, 2)}) {
    view.features.descriptors[0] = d;
    map.add_keyframe(0, 0, view);
  }
  const std::uint32_t landmark = map.add_landmark({0, 0});
  for (std::uint32_t k = 1; k < 4; ++k) map.add_observation(landmark, {k, 0});
  map.summarize(landmark);
  EXPECT_EQ(map.landmark(landmark).descriptor, middle);
}

TEST(SlamMap, JoiningSegmentsMovesOneAndLeavesTheOther) {
  std::mt19937_64 rng(1);
  SlamMap map(test_camera(), 1.2F, 8);
  map.add_keyframe(0, 0, grid_view(10, 2.0F, &rng));
  map.add_keyframe(1, 1, grid_view(10, 2.0F, &rng));
  const std::uint32_t here = map.add_landmark({0, 0}), there = map.add_landmark({1, 0});
  const Eigen::Vector3d stays = map.landmark(here).position_m, moves = map.landmark(there).position_m;
  const Rigid3 T_0_1{exp_so3({0, 0.5, 0}), {3, 0, 1}};
  map.join_segments(1, 0, T_0_1);
  EXPECT_EQ(map.landmark(here).position_m, stays);
  EXPECT_LT((map.landmark(there).position_m - T_0_1 * moves).norm(), 1e-12);
  EXPECT_EQ(map.keyframe(1).segment, 0U);
  EXPECT_LT((map.keyframe(1).view.T_map_camera.translation - T_0_1.translation).norm(), 1e-12);
  const Eigen::Vector3d direction = (map.keyframe(1).view.T_map_camera.translation - map.landmark(there).position_m).normalized();
  EXPECT_LT((map.landmark(there).direction - direction).norm(), 1e-9);
  expect_consistent(map);
}

TEST(SlamMap, ScaleAndNoiseGrowWithTheLevel) {
  const SlamMap map(test_camera(), 1.2F, 8);
  EXPECT_FLOAT_EQ(map.levels().scale(0), 1);
  EXPECT_NEAR(map.levels().scale(7), std::pow(1.2, 7), 1e-4);
  EXPECT_EQ(map.levels().scale(200), map.levels().scale(7));  // levels from outside are not believed
  for (std::uint8_t level = 1; level < 8; ++level)
    EXPECT_GT(map.levels().sigma_px(level), map.levels().sigma_px(static_cast<std::uint8_t>(level - 1)));
}

}  // namespace
}  // namespace camloc
