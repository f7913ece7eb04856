// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The plan of a map: what is cut off, which way its walls run, and what fits into the picture.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "tests/map/room_map.h"
#include "tools/mapping/picture/map_picture.h"

namespace camloc::mapping {
namespace {

class MapSceneTest : public ::testing::Test {
 protected:
  Scene scene_of(const MapData& data) {
    EXPECT_TRUE(write_map(data, folder_.file("m.cmap")).is_ok());
    map_.emplace(std::move(MapView::open(folder_.file("m.cmap"))).value());
    picture_.map = &*map_;
    return make_scene(picture_);
  }
  testing::TemporaryFolder folder_;
  std::optional<MapView> map_;
  MapPicture picture_;
};

TEST_F(MapSceneTest, WhatHangsAboveTheCamerasIsCutOff) {
  const Scene scene = scene_of(testing::make_room_map());  // cameras at 1.5 m, landmarks up to 2.5 m
  EXPECT_TRUE(scene.is_cut);
  ASSERT_EQ(scene.colors.size(), scene.landmarks.size());
  EXPECT_LT(scene.landmarks.size(), map_->landmarks().size());
  EXPECT_GT(scene.landmarks.size(), map_->landmarks().size() / 2);
  for (const Eigen::Vector3d& p : scene.landmarks) EXPECT_LT(p.z(), 2.1 + 1e-6);
  EXPECT_EQ(scene.keyframes.size(), 9U);
  EXPECT_LT(scene.low_m, 0.2);
  EXPECT_NEAR(scene.high_m, 2.1, 0.1);
}

TEST_F(MapSceneTest, ThePlanHasTheLongSideToTheRight) {
  const Scene scene = scene_of(testing::make_room_map());  // 6 m along x, 4 m along y
  const Plan plan = make_plan(scene);
  EXPECT_GT(plan.right.x(), 0.99);
  EXPECT_LT(plan.down.y(), -0.99);
  EXPECT_NEAR(plan.u.length(), 6, 0.3);
  EXPECT_NEAR(plan.v.length(), 4, 0.2);
  const Viewpoint view = top_view(plan, 700, 500, 50);
  EXPECT_NEAR(view.px_per_m, std::min(600 / plan.u.length(), 400 / plan.v.length()), 1e-9);
  const Eigen::Vector3d low = view.T_view_world * (plan.u.low * plan.right + plan.v.low * plan.down);
  EXPECT_GE(view.center_u + view.px_per_m * low.x(), 49.0);
  EXPECT_GE(view.center_v + view.px_per_m * low.y(), 49.0);
}

TEST_F(MapSceneTest, AWalkOutsideIsInThePlan) {
  picture_.trajectory = {{Eigen::Quaterniond::Identity(), {0, 0, 1.5}}, {Eigen::Quaterniond::Identity(), {-20, 0, 1.5}}};
  const Plan plan = make_plan(scene_of(testing::make_room_map()));
  EXPECT_LE(plan.u.low, -20);
}

}  // namespace
}  // namespace camloc::mapping
