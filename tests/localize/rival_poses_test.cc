// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A room and its exact copy 20 m away: with what the map knows about them no view of one is believed to be a view of the other.
#include "core/localize/rival_poses.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/map/map_unpack.h"
#include "tests/localize/sample_world.h"

namespace camloc {
namespace {

using testing::SampleWorld;

constexpr double kFarM = 20;

/// The sample room and a copy of it; `knows` adds what `camloc map upgrade` would find. Landmarks with y below `unique_below_y` are in
/// the first room alone.
MapData two_rooms(bool knows, double unique_below_y = -1e9) {
  MapData map = testing::with_copy({kFarM, 0, 0}, [=](std::uint32_t, const Eigen::Vector3d& p) { return p.y() >= unique_below_y; });
  if (!knows) return map;
  // Sections go by the order in the file.
  const testing::MapOnDisk plain(map);
  map = unpack_map(*plain.view);
  std::vector<map_format::RivalRecord> records;
  const auto num = static_cast<std::uint32_t>(map.keyframes.size());
  for (std::uint32_t k = 0; k < num; ++k) {
    const std::uint32_t twin = (k + num / 2) % num;
    records.push_back(pack_rival(k, {twin, map.keyframes[twin].T_map_camera}, map.keyframes[twin].T_map_camera));
  }
  const auto bytes = std::as_bytes(std::span(records));
  map.extra_sections[map_format::kRivals] = {true, sizeof(map_format::RivalRecord), {bytes.begin(), bytes.end()}};
  std::vector<std::byte> twins;
  for (const MapLandmark& landmark : map.landmarks)
    twins.push_back(landmark.position_m.y() >= unique_below_y ? std::byte{1} : std::byte{0});
  map.extra_sections[map_format::kTwins] = {true, 1, twins};
  return map;
}

TEST(RivalPoses, AreThoseOfTheNearestKeyframesOnceEach) {
  const testing::MapOnDisk rooms(two_rooms(true));
  RivalPoses rivals(*rooms.view, {});
  const Rigid3 here = rooms.view->keyframe_pose(0);
  const auto poses = rivals.of(here);
  ASSERT_EQ(poses.size(), 1U);
  EXPECT_NEAR((poses[0].translation - here.translation).x(), kFarM, 0.01);
  EXPECT_LT(rotation_distance_rad(poses[0].rotation, here.rotation), 0.01);
  EXPECT_TRUE(rivals.of({here.rotation, here.translation + Eigen::Vector3d(0, 0, 50)}).empty()) << "nothing was mapped there";
}

TEST(RivalPoses, NobodyAsksForMoreThanThereIsRoomFor) {
  const testing::MapOnDisk rooms(two_rooms(true));
  LocalizerNumbers numbers;
  numbers.max_rivals = 0;
  RivalPoses rivals(*rooms.view, numbers);
  EXPECT_TRUE(rivals.of(rooms.view->keyframe_pose(0)).empty());
}

TEST(RivalPoses, AMapThatDoesNotKnowNamesNone) {
  const testing::MapOnDisk rooms(two_rooms(false));
  RivalPoses rivals(*rooms.view, {});
  EXPECT_FALSE(rivals.look_alikes().is_known());
  EXPECT_TRUE(rivals.of(rooms.view->keyframe_pose(0)).empty());
}

TEST(RivalPoses, IdenticalRoomsAreAmbiguousEvenIfOnlyOneIsProposed) {
  const SampleWorld& world = SampleWorld::get();
  const testing::MapOnDisk rooms(two_rooms(true));
  LocalizerOptions options;
  options.use_tracking = false;
  options.numbers.max_places = 1;
  Localizer localizer(*rooms.view, world.camera(), options);
  for (const std::uint64_t i : {2U, 10U, 20U}) {
    const Localization& result = localizer.process(world.frame(i).view());
    EXPECT_EQ(result.state, State::kCoarse) << i;
    EXPECT_EQ(result.reason, Reason::kAmbiguous) << i;
  }
}

TEST(RivalPoses, ATrackedPlaceIsHeldAgainstItsLookAlike) {
  const SampleWorld& world = SampleWorld::get();
  double middle_y = 0;
  for (const MapLandmark& landmark : world.data().landmarks) middle_y += landmark.position_m.y();
  middle_y /= static_cast<double>(world.data().landmarks.size());
  const testing::MapOnDisk rooms(two_rooms(true, middle_y));
  Localizer localizer(*rooms.view, world.camera(), {});
  int num_tracked = 0, num_asked = 0;
  for (std::uint64_t i = 0; i < testing::kMappedFrames; ++i) {
    const Localization& result = localizer.process(world.frame(i).view());
    if (result.state != State::kLocalized) continue;
    EXPECT_LT(result.T_map_camera.translation.x(), kFarM / 2) << "frame " << i << " is in the copy";
    num_tracked += result.is_tracked ? 1 : 0;
    num_asked += result.is_tracked && std::isfinite(result.standing.lead) ? 1 : 0;
  }
  EXPECT_GT(num_tracked, 60);
  EXPECT_GT(num_asked, num_tracked / 4);
}

TEST(RivalPoses, WhatOnlyOneRoomHasDecides) {
  const SampleWorld& world = SampleWorld::get();
  double middle_y = 0;
  for (const MapLandmark& landmark : world.data().landmarks) middle_y += landmark.position_m.y();
  middle_y /= static_cast<double>(world.data().landmarks.size());
  const testing::MapOnDisk rooms(two_rooms(true, middle_y));
  LocalizerOptions options;
  options.use_tracking = false;
  Localizer localizer(*rooms.view, world.camera(), options);
  int num_localized = 0;
  for (std::uint64_t i = 0; i < 24; ++i) {
    const Localization& result = localizer.process(world.frame(i).view());
    if (result.state != State::kLocalized) continue;
    ++num_localized;
    EXPECT_LT(result.T_map_camera.translation.x(), kFarM / 2) << "frame " << i << " is in the copy";
    EXPECT_GT(result.standing.lead, LocalizerNumbers{}.min_lead);
  }
  EXPECT_GT(num_localized, 6);
}

}  // namespace
}  // namespace camloc
