// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/common/map_points.h"

#include <gtest/gtest.h>

#include "tests/map/room_map.h"

namespace camloc::tools {
namespace {

TEST(MapPoints, AreTheLandmarksInTheirOrderWithoutTheThinOnes) {
  const testing::TemporaryFolder folder;
  ASSERT_TRUE(write_map(testing::make_room_map(), folder.file("m.cmap")).is_ok());
  const auto map = MapView::open(folder.file("m.cmap"));
  ASSERT_TRUE(map.is_ok());
  const auto all = landmark_positions(*map);
  ASSERT_EQ(all.size(), map->landmarks().size());
  std::vector<Eigen::Vector3d> often;
  for (std::uint32_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i], map->position_m(i).cast<double>());
    if (map->landmarks()[i].num_observations >= 50) often.push_back(all[i]);
  }
  ASSERT_GT(often.size(), 0U);
  EXPECT_LT(often.size(), all.size());
  EXPECT_EQ(landmark_positions(*map, 50), often);
}

}  // namespace
}  // namespace camloc::tools
