// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A keyframe of a map as if it were an image: its landmarks where its camera sees them.
#include "core/map/keyframe_view.h"

#include <gtest/gtest.h>

#include "tests/localize/sample_world.h"

namespace camloc {
namespace {

TEST(KeyframeView, ShowsTheLandmarksOfTheKeyframeWhereTheyAre) {
  const MapData& map = testing::SampleWorld::get().data();
  for (std::uint32_t k = 0; k < map.keyframes.size(); ++k) {
    const KeyframeView seen = view_of_keyframe(map, k);
    ASSERT_EQ(seen.landmarks.size(), seen.view.size());
    EXPECT_GT(seen.landmarks.size(), map.keyframes[k].landmarks.size() * 9 / 10) << "nearly all lie in the image";
    const Rigid3 T_camera_map = map.keyframes[k].T_map_camera.inverse();
    EXPECT_EQ(seen.view.T_map_camera.translation, map.keyframes[k].T_map_camera.translation);
    for (std::size_t i = 0; i < seen.landmarks.size(); ++i) {
      const MapLandmark& landmark = map.landmarks[seen.landmarks[i]];
      const Eigen::Vector3d p = T_camera_map * landmark.position_m.cast<double>();
      const Eigen::Vector2d pixel = map.camera.color.project(p);
      const Keypoint& keypoint = seen.view.features.keypoints[i];
      EXPECT_NEAR(keypoint.u, pixel.x(), 1e-3);
      EXPECT_NEAR(keypoint.v, pixel.y(), 1e-3);
      EXPECT_LT(keypoint.level, map.orb_num_levels);
      EXPECT_EQ(seen.view.features.descriptors[i], landmark.descriptors.front());
      const bool is_in_range = p.z() >= map.camera.min_depth_m && p.z() <= map.camera.max_depth_m;
      EXPECT_NEAR(seen.view.depth_m[i], is_in_range ? p.z() : 0, 1e-5);
    }
  }
}

TEST(KeyframeView, WhatLiesBehindOrOutsideIsLeftOut) {
  MapData map = testing::SampleWorld::get().data();
  map.keyframes[0].T_map_camera.rotation = map.keyframes[0].T_map_camera.rotation * exp_so3({0, 3.14159, 0});
  EXPECT_LT(view_of_keyframe(map, 0).landmarks.size(), map.keyframes[0].landmarks.size() / 10);
}

}  // namespace
}  // namespace camloc
