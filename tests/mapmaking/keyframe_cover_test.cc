// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapmaking/keyframe_cover.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <random>

namespace camloc {
namespace {

using ItemViews = std::vector<std::vector<std::uint32_t>>;

ItemViews random_views(std::mt19937& random, std::size_t num_views, std::uint32_t num_items, double density) {
  std::bernoulli_distribution sees(density);
  ItemViews views(num_views);
  for (std::uint32_t item = 0; item < num_items; ++item) {
    for (auto& view : views) {
      if (sees(random)) view.push_back(item);
    }
  }
  return views;
}

std::uint32_t mask_of(const std::vector<std::uint32_t>& items) {
  std::uint32_t mask = 0;
  for (const std::uint32_t item : items) mask |= 1U << item;
  return mask;
}

/// Size of the smallest cover of everything that is in some view, by trying all subsets.
int minimum_cover(const ItemViews& views) {
  std::uint32_t all = 0;
  for (const auto& view : views) all |= mask_of(view);
  int best = static_cast<int>(views.size());
  for (std::uint32_t subset = 0; subset < (1U << views.size()); ++subset) {
    std::uint32_t covered = 0;
    for (std::size_t v = 0; v < views.size(); ++v) covered |= (subset >> v & 1U) != 0 ? mask_of(views[v]) : 0;
    if (covered == all) best = std::min(best, std::popcount(subset));
  }
  return best;
}

TEST(KeyframeCover, IsWithinTheGreedyBoundOfTheMinimum) {
  std::mt19937 random(1);
  int total = 0, total_minimum = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const ItemViews views = random_views(random, 10, 24, 0.25);
    const KeyframeCover cover = cover_with_keyframes(views, 24);
    std::uint32_t covered = 0, all = 0;
    for (const std::uint32_t v : cover.views) covered |= mask_of(views[v]);
    for (const auto& view : views) all |= mask_of(view);
    EXPECT_EQ(covered, all);
    EXPECT_EQ(cover.uncovered.size(), 24U - static_cast<unsigned>(std::popcount(all)));
    const int minimum = minimum_cover(views);
    EXPECT_LE(static_cast<double>(cover.views.size()), (std::log(24.0) + 1) * minimum);
    total += static_cast<int>(cover.views.size());
    total_minimum += minimum;
  }
  EXPECT_LE(total, 1.15 * total_minimum);
}

TEST(KeyframeCover, HasNoSuperfluousView) {
  std::mt19937 random(2);
  const ItemViews views = random_views(random, 80, 400, 0.08);
  const KeyframeCover cover = cover_with_keyframes(views, 400);
  for (const std::uint32_t left_out : cover.views) {
    std::vector<int> times(400, 0);
    for (const std::uint32_t v : cover.views) {
      for (const std::uint32_t item : views[v]) times[item] += v == left_out ? 0 : 1;
    }
    EXPECT_TRUE(std::any_of(views[left_out].begin(), views[left_out].end(), [&](std::uint32_t i) { return times[i] == 0; })) << left_out;
  }
}

TEST(KeyframeCover, RemovesAViewThatLaterOnesMakeSuperfluous) {
  // Greedy takes the middle view first; the two others then cover it completely.
  const ItemViews views = {{0, 1, 2, 3}, {2, 3, 4, 5, 6}, {4, 5, 6, 7}};
  EXPECT_EQ(cover_with_keyframes(views, 8).views, (std::vector<std::uint32_t>{0, 2}));
}

TEST(KeyframeCover, TakesTheLowerIndexAmongEquals) {
  EXPECT_EQ(cover_with_keyframes(ItemViews{{0, 1}, {0, 1}, {}}, 2).views, (std::vector<std::uint32_t>{0}));
}

TEST(KeyframeCover, LeavesItemsThatOnlyAPoorViewWouldAdd) {
  const ItemViews views = {{0, 1, 2, 3}, {3, 4}, {5, 6, 7}};
  const KeyframeCover cover = cover_with_keyframes(views, 8, 2);
  EXPECT_EQ(cover.views, (std::vector<std::uint32_t>{0, 2}));
  EXPECT_EQ(cover.uncovered, (std::vector<std::uint32_t>{4}));
}

TEST(KeyframeCover, OfNothingIsNothing) {
  const KeyframeCover cover = cover_with_keyframes({}, 3);
  EXPECT_TRUE(cover.views.empty());
  EXPECT_EQ(cover.uncovered.size(), 3U);
}

}  // namespace
}  // namespace camloc
