// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/localize/place_grouping.h"

#include <gtest/gtest.h>

#include "tests/localize/sample_world.h"

namespace camloc {
namespace {

/// The sample map with a copy of all 20 m away: keyframes of both halves.
const testing::MapOnDisk& two_rooms() {
  static const testing::MapOnDisk map(testing::with_copy({20, 0, 0}, [](std::uint32_t, const Eigen::Vector3d&) { return true; }));
  return map;
}

struct Grouped {
  LocalizerNumbers numbers;
  PlaceGrouping grouping;
  explicit Grouped(const LocalizerNumbers& n = {}) : numbers(n), grouping({two_rooms().view.get(), nullptr, &numbers, 1000}) {}
  std::size_t num_views() {
    std::size_t sum = 0;
    for (const Proposal& place : grouping.places()) sum += place.places().size();
    return sum;
  }
};

TEST(PlaceGrouping, NearViewsAreOnePlaceFarOnesAreAnother) {
  Grouped g;
  const auto num = static_cast<std::uint32_t>(two_rooms().view->keyframes().size());
  ASSERT_GE(num, 4U);
  g.grouping.add(0);
  g.grouping.add(num / 2);  // the twin of 0
  ASSERT_EQ(g.grouping.places().size(), 2U);
  EXPECT_EQ(g.grouping.places()[0].places().front(), 0U);
  EXPECT_EQ(g.grouping.places()[1].places().front(), num / 2);
  g.grouping.add(0);
  EXPECT_EQ(g.grouping.places().size(), 2U);
  EXPECT_EQ(g.grouping.places()[0].places().size(), 2U);
  g.grouping.clear();
  EXPECT_TRUE(g.grouping.places().empty());
}

TEST(PlaceGrouping, KeepsToItsBounds) {
  Grouped few({.max_places = 1, .max_keyframes_per_place = 2});
  for (std::uint32_t k = 0; k < two_rooms().view->keyframes().size(); ++k) few.grouping.add(k);
  EXPECT_EQ(few.grouping.places().size(), 1U);
  EXPECT_LE(few.num_views(), 2U);
  Grouped many({.max_places = 1, .max_keyframes_per_place = 1000, .place_radius_m = 1000, .place_angle_rad = 10});
  for (std::uint32_t k = 0; k < two_rooms().view->keyframes().size(); ++k) many.grouping.add(k);
  EXPECT_LE(many.num_views(), static_cast<std::size_t>(Proposal::kMaxKeyframes));
}

}  // namespace
}  // namespace camloc
