// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What a map says about its look-alikes is read as it was written, and refused when it cannot be true.
#include "core/map/look_alikes.h"

#include <gtest/gtest.h>

#include "core/map/map_writer.h"
#include "tests/map/synthetic_map.h"

namespace camloc {
namespace {

using map_format::RivalRecord;

MapData plain_map() { return testing::make_synthetic_map({.num_landmarks = 20, .num_keyframes = 3, .num_words = 3}); }

void set_sections(MapData* map, const std::vector<RivalRecord>& records, std::size_t num_twins) {
  const auto bytes = std::as_bytes(std::span(records));
  map->extra_sections[map_format::kRivals] = {true, sizeof(RivalRecord), {bytes.begin(), bytes.end()}};
  map->extra_sections[map_format::kTwins] = {true, 1, std::vector<std::byte>(num_twins, std::byte{0})};
}

Result<MapView> written(const MapData& map, const testing::TemporaryFolder& folder) {
  const Status status = write_map(map, folder.file("m.cmap"));
  EXPECT_TRUE(status.is_ok()) << status.message();
  return MapView::open(folder.file("m.cmap"));
}

TEST(LookAlikes, PosesAndTwinsAreReadAsTheyWereWritten) {
  MapData map = plain_map();
  testing::Random random(5);
  const RivalPose here{2, {random.rotation(), map.keyframes[2].T_map_camera.translation + Eigen::Vector3d(0.5, -3, 1)}};
  set_sections(&map,
               {pack_rival(0, here, map.keyframes[2].T_map_camera),
                pack_rival(0, {1, map.keyframes[1].T_map_camera}, map.keyframes[1].T_map_camera)},
               20);
  map.extra_sections[map_format::kTwins].bytes[7] = std::byte{3};
  const testing::TemporaryFolder folder;
  const auto view = written(map, folder);
  ASSERT_TRUE(view.is_ok()) << view.status().message();
  const LookAlikes look_alikes(*view);
  EXPECT_TRUE(look_alikes.is_known());
  for (std::uint32_t i = 0; i < 20; ++i) EXPECT_EQ(look_alikes.is_repeated(i), i == 7);
  EXPECT_FALSE(look_alikes.is_repeated(20)) << "beyond the last";
  ASSERT_EQ(look_alikes.num_rivals(0), 2U);
  EXPECT_EQ(look_alikes.num_rivals(1), 0U);
  EXPECT_EQ(look_alikes.num_rivals(2), 0U);
  EXPECT_EQ(look_alikes.rival(0, 0).keyframe, 2U) << "in the order of the file";
  EXPECT_LT((look_alikes.rival(0, 0).T_map_camera.translation - here.T_map_camera.translation).norm(), 1e-3);
  EXPECT_LT(rotation_distance_rad(look_alikes.rival(0, 0).T_map_camera.rotation, here.T_map_camera.rotation), 1e-3);
}

TEST(LookAlikes, AMapWithoutThemIsReadAndSaysSo) {
  const testing::TemporaryFolder folder;
  const auto view = written(plain_map(), folder);
  ASSERT_TRUE(view.is_ok());
  const LookAlikes look_alikes(*view);
  EXPECT_FALSE(look_alikes.is_known());
  for (std::uint32_t k = 0; k < 3; ++k) EXPECT_EQ(look_alikes.num_rivals(k), 0U);
}

TEST(LookAlikes, LiesAreRefused) {
  const RivalRecord good{0, 1, {}, {}};
  const struct {
    const char* what;
    std::vector<RivalRecord> records;
    std::size_t num_twins;
  } lies[] = {
      {"a keyframe that is not there", {{3, 1, {}, {}}}, 20},
      {"a rival that is not there", {{0, 3, {}, {}}}, 20},
      {"its own rival", {{1, 1, {}, {}}}, 20},
      {"out of order", {{1, 0, {}, {}}, good}, 20},
      {"twins of other landmarks", {good}, 19},
      {"no twins at all", {good}, 0},
  };
  const testing::TemporaryFolder folder;
  for (const auto& lie : lies) {
    MapData map = plain_map();
    set_sections(&map, lie.records, lie.num_twins);
    const auto view = written(map, folder);
    ASSERT_FALSE(view.is_ok()) << lie.what;
    EXPECT_EQ(view.status().code(), ErrorCode::kCorrupt) << lie.what;
    EXPECT_NE(view.status().message().find("look-alike"), std::string::npos) << view.status().message();
  }
}

}  // namespace
}  // namespace camloc
