// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Places made of random descriptors, seen again with flipped bits.
#include "core/slam/loops/place_index.h"

#include <gtest/gtest.h>

#include "tests/slam/generated_walk.h"

namespace camloc {
namespace {

/// Flips some bits of each.
std::vector<Descriptor> seen_again(std::vector<Descriptor> descriptors, std::uint64_t seed, int flipped_bits = 16) {
  std::mt19937_64 rng(seed);
  for (Descriptor& d : descriptors) {
    for (int i = 0; i < flipped_bits; ++i) d.bits[rng() % 4] ^= std::uint64_t{1} << (rng() % 64);
  }
  return descriptors;
}

/// Corners of a building come in kinds; a place shows some of these.
std::vector<Descriptor> place(std::uint64_t number, std::size_t count = 150) {
  constexpr std::size_t kKinds = 200, kKindsPerPlace = 25;
  std::mt19937_64 kinds_rng(4711), rng(number);
  std::vector<Descriptor> kinds(kKinds), here, descriptors;
  for (Descriptor& d : kinds) d = testing::random_descriptor(kinds_rng);
  for (std::size_t i = 0; i < kKindsPerPlace; ++i) here.push_back(kinds[rng() % kKinds]);
  for (std::size_t i = 0; i < count; ++i) descriptors.push_back(here[rng() % kKindsPerPlace]);
  return seen_again(descriptors, number, 24);
}

TEST(PlaceIndex, KnowsNothingBeforeTheFirstWords) {
  PlaceIndex index;
  EXPECT_TRUE(index.query(place(1), 5).empty());
  for (std::uint64_t k = 0; k < 7; ++k) index.add(place(k));
  EXPECT_TRUE(index.query(place(1), 5).empty());
  index.add(place(7));
  EXPECT_FALSE(index.query(place(1), 5).empty());
}

// At 8, 16 and 32 places the words are trained anew; every place of before must be found with the new ones.
TEST(PlaceIndex, FindsEveryPlaceAtEveryNumberOfPlaces) {
  PlaceIndex index;
  for (std::uint64_t k = 0; k < 40; ++k) {
    index.add(seen_again(place(k), 1000 + k));
    if (k < 7 || (k % 8 != 0 && k % 8 != 7)) continue;
    for (std::uint64_t query = 0; query <= k; ++query) {
      const auto ranked = index.query(seen_again(place(query), 2000 + query), 3);
      ASSERT_EQ(ranked.size(), 3U);
      EXPECT_EQ(ranked[0].keyframe, query) << "of " << k + 1;
      EXPECT_GT(ranked[0].score, ranked[1].score);
      EXPECT_GE(ranked[1].score, ranked[2].score);
      EXPECT_LE(ranked[0].score, 1.0001F);
    }
  }
}

TEST(PlaceIndex, TheSamePlacesGiveTheSameBits) {
  const auto run = [] {
    PlaceIndex index;
    for (std::uint64_t k = 0; k < 20; ++k) index.add(place(k, 100 + 10 * (k % 3)));
    return index.query(seen_again(place(5), 1), 20);
  };
  const auto a = run(), b = run();
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].keyframe, b[i].keyframe);
    EXPECT_EQ(a[i].score, b[i].score);
  }
}

TEST(PlaceIndex, EmptyAndCrowdedPlacesAreTaken) {
  PlaceIndex index;
  for (std::uint64_t k = 0; k < 12; ++k) index.add(k % 3 == 0 ? std::vector<Descriptor>{} : place(k, k % 3 == 1 ? 3000 : 20));
  EXPECT_TRUE(index.query({}, 5).empty());
  EXPECT_TRUE(index.query(place(4, 3000), 0).empty());
  const auto ranked = index.query(place(4, 3000), 100);
  ASSERT_FALSE(ranked.empty());
  EXPECT_EQ(ranked[0].keyframe, 4U);
  for (const RankedKeyframe& r : ranked) EXPECT_NE(r.keyframe % 3, 0U);  // a place without features is like nothing
}

TEST(PlaceIndex, OnlyEmptyPlaces) {
  PlaceIndex index;
  for (int k = 0; k < 20; ++k) index.add({});
  EXPECT_TRUE(index.query(place(1), 5).empty());
}

}  // namespace
}  // namespace camloc
