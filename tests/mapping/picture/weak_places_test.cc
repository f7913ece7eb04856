// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The table names the places a person has to go to, and what to do there.
#include <gtest/gtest.h>

#include "tests/map/room_map.h"
#include "tools/mapping/picture/map_picture.h"

namespace camloc::mapping {
namespace {

using testing::make_room_map;

class WeakPlacesTest : public ::testing::Test {
 protected:
  MapView open(const MapData& data) {
    EXPECT_TRUE(write_map(data, folder_.file("m.cmap")).is_ok());
    return MapView::open(folder_.file("m.cmap")).value();
  }
  testing::TemporaryFolder folder_;
};

TEST_F(WeakPlacesTest, NeighboursAreOneWeakPlaceAndTheWorstComesFirst) {
  const MapView map = open(make_room_map());
  std::vector<KeyframeLocalizability> places(9);
  for (const std::uint32_t k : {0U, 1U, 8U}) {
    places[k].outlook = FixOutlook::kScanAgain;
    places[k].weakness = FixWeakness::kFewLandmarks;
    places[k].num_landmarks = 10 + k;
    places[k].position_sigma_m = k == 8 ? 0.5 : 0.1 + 0.01 * k;
  }
  const auto weak = find_weak_places(map, places, 5);
  ASSERT_EQ(weak.size(), 2U);
  EXPECT_EQ(weak[0].keyframe, 8U);
  EXPECT_EQ(weak[0].num_keyframes, 1U);
  EXPECT_EQ(weak[1].keyframe, 1U);
  EXPECT_EQ(weak[1].num_keyframes, 2U);
  EXPECT_EQ(find_weak_places(map, places, 1).size(), 1U);
  const std::string table = format_places(map, places, weak);
  EXPECT_NE(table.find("66.7 %"), std::string::npos) << table;
  EXPECT_NE(table.find("only 18 landmarks"), std::string::npos) << table;
  EXPECT_NE(table.find("0.60      0.00      1.50"), std::string::npos) << table;
}

TEST_F(WeakPlacesTest, PositionsAreOfTheSiteWhereTheMapHasOne) {
  const MapView map = open(make_room_map({.has_wcs = true}));
  std::vector<KeyframeLocalizability> places(9);
  places[0].outlook = FixOutlook::kLookAlike;
  places[0].rival = RivalPlace{8, 0.4, 50, 45};
  places[0].num_landmarks = 100;
  const std::string table = format_places(map, places, find_weak_places(map, places, 5));
  EXPECT_NE(table.find("site coordinates"), std::string::npos) << table;
  EXPECT_NE(table.find("350012"), std::string::npos) << table;
  EXPECT_NE(table.find("45 of 100 landmarks"), std::string::npos) << table;
}

TEST_F(WeakPlacesTest, EachReasonHasItsAdvice) {
  const MapView map = open(make_room_map());
  KeyframeLocalizability place;
  place.outlook = FixOutlook::kScanAgain;
  place.num_landmarks = 12;
  place.spread = 0.25;
  place.position_sigma_m = 0.123;
  place.weakness = FixWeakness::kFewLandmarks;
  EXPECT_NE(explain(map, place).find("only 12 landmarks"), std::string::npos);
  place.weakness = FixWeakness::kPoorSpread;
  EXPECT_NE(explain(map, place).find("only 25 %"), std::string::npos);
  place.weakness = FixWeakness::kImprecise;
  EXPECT_NE(explain(map, place).find("12.3 cm"), std::string::npos);
  place.weakness = FixWeakness::kNone;
  EXPECT_EQ(explain(map, place), "");
  EXPECT_NE(format_places(map, std::vector<KeyframeLocalizability>(9), {}).find("no weak places"), std::string::npos);
}

// Two places that look like each other are one finding, not two.
TEST_F(WeakPlacesTest, AMirroredPairIsNamedOnce) {
  const MapView map = open(make_room_map());
  std::vector<KeyframeLocalizability> places(9);
  for (const auto& [k, other] : {std::pair{0U, 8U}, {8U, 0U}}) {
    places[k].outlook = FixOutlook::kLookAlike;
    places[k].rival = RivalPlace{other, 0.5, 100, 90};
    places[k].num_landmarks = 100;
  }
  const auto weak = find_weak_places(map, places, 5);
  ASSERT_EQ(weak.size(), 1U);
  EXPECT_EQ(weak[0].num_keyframes, 2U);
}

}  // namespace
}  // namespace camloc::mapping
