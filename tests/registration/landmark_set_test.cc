// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Which landmarks are gathered, and where they appear in an image.
#include "core/registration/landmark_set.h"

#include <gtest/gtest.h>

#include "tests/slam/true_keyframes.h"

namespace camloc {
namespace {

using testing::looking;
using testing::TrueKeyframes;

void add_three(TrueKeyframes* f) {
  for (int k = 0; k < 3; ++k) f->add(looking({0.1 * k, 0, 1.4}, 0.15 * k - 0.2));
}

TEST(LandmarkSet, HoldsEachLandmarkOnceInTheOrderOfTheKeyframes) {
  TrueKeyframes f(testing::make_room());
  add_three(&f);
  LandmarkSet set = f.map.empty_landmark_set();
  const std::uint32_t keyframes[] = {2, 1, 2};
  f.map.collect_landmarks(keyframes, 100000, &set);
  EXPECT_EQ(set.size(), f.map.keyframe(2).num_landmarks + f.map.keyframe(1).num_landmarks);  // none are shared
  EXPECT_EQ(f.map.landmark(set.id(0)).observations.front().keyframe, 2U);
  EXPECT_EQ(set.position_m(0), f.map.landmark(set.id(0)).position_m.cast<float>());
  EXPECT_EQ(set.descriptors().size(), set.size());
  f.map.collect_landmarks(keyframes, 50, &set);
  EXPECT_EQ(set.size(), 50U);
}

TEST(LandmarkSet, ProjectsWhatIsInView) {
  TrueKeyframes f(testing::make_room());
  add_three(&f);
  const Rigid3 T = f.map.keyframe(0).view.T_map_camera;
  LandmarkSet set = f.map.empty_landmark_set();
  const std::uint32_t keyframe = 0;
  f.map.collect_landmarks({&keyframe, 1}, 100000, &set);
  const auto visible = set.project(T, 9);
  // From where they were made all are in view, at their features.
  EXPECT_GE(visible.size() + 3, set.size());
  for (const ProjectedLandmark& p : visible) {
    const SlamLandmark& landmark = f.map.landmark(set.id(static_cast<std::size_t>(p.landmark)));
    const Keypoint& keypoint = f.map.keyframe(0).view.features.keypoints[landmark.observations.front().feature];
    EXPECT_NEAR(p.u, keypoint.u, 0.01);
    EXPECT_NEAR(p.v, keypoint.v, 0.01);
    EXPECT_LE(p.min_level, keypoint.level);
    EXPECT_GE(p.max_level, keypoint.level);
    EXPECT_EQ(p.radius_px, 9);
  }
  // From behind, from far aside and from far away there is nothing to see.
  EXPECT_TRUE(set.project(looking({0, 0, 1.4}, 3.0), 9).empty());
  EXPECT_TRUE(set.project(looking({50, 0, 1.4}, std::numbers::pi), 9).empty());
}

}  // namespace
}  // namespace camloc
