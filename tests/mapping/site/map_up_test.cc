// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Which way is up: told by how the camera was held, by the shape of the map, or by the site.
#include "tools/mapping/site/map_up.h"

#include <gtest/gtest.h>

#include "tests/map/room_map.h"

namespace camloc::mapping {
namespace {

using testing::make_room_map;

class MapUpTest : public ::testing::Test {
 protected:
  MapView open(const MapData& data) {
    EXPECT_TRUE(write_map(data, folder_.file("m.cmap")).is_ok());
    return MapView::open(folder_.file("m.cmap")).value();
  }
  testing::TemporaryFolder folder_;
};

TEST_F(MapUpTest, UpIsAcrossTheImageRowsOfAMapThatLiesAskew) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.6, Eigen::Vector3d(1, 0.3, 0.1).normalized()));
  MapData askew = make_room_map();
  for (MapLandmark& landmark : askew.landmarks) landmark.position_m = (turn * landmark.position_m.cast<double>()).cast<float>();
  for (MapKeyframe& keyframe : askew.keyframes) keyframe.T_map_camera = Rigid3{turn, {0, 0, 0}} * keyframe.T_map_camera;
  EXPECT_LT((up_axis(open(askew)) - turn * Eigen::Vector3d::UnitZ()).norm(), 1e-3);
}

TEST_F(MapUpTest, UpIsTheFlatAxisWhereCamerasDoNotTurnAndTheSitesZWhereThereIsOne) {
  EXPECT_EQ(up_axis(open(make_room_map())), Eigen::Vector3d(0, 0, 1));
  EXPECT_EQ(up_axis(open(make_room_map({.num_keyframes = 1}))), Eigen::Vector3d(0, 0, 1));
  MapData turned = make_room_map();
  turned.wcs.emplace();
  turned.wcs->T_wcs_map.rotation = Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX());
  const MapView map = open(turned);
  EXPECT_LT((turned.wcs->T_wcs_map.rotation * up_axis(map) - Eigen::Vector3d::UnitZ()).norm(), 1e-12);
}

TEST_F(MapUpTest, ACameraHeldUpsideDownTurnsIt) {
  MapData room = make_room_map();
  const Eigen::Quaterniond half_turn(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ()));  // about the optical axis
  for (MapKeyframe& keyframe : room.keyframes) keyframe.T_map_camera.rotation = keyframe.T_map_camera.rotation * half_turn;
  EXPECT_EQ(up_axis(open(room)), Eigen::Vector3d(0, 0, -1));
}

}  // namespace
}  // namespace camloc::mapping
