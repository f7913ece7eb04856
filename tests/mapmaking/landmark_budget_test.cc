// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapmaking/landmark_budget.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace camloc {
namespace {

using Views = std::vector<std::vector<ViewObservation>>;

std::vector<int> kept_per_view(const Views& views, const std::vector<std::uint32_t>& kept) {
  std::vector<int> counts;
  for (const auto& view : views) {
    counts.push_back(static_cast<int>(std::count_if(
        view.begin(), view.end(), [&](const ViewObservation& o) { return std::binary_search(kept.begin(), kept.end(), o.landmark); })));
  }
  return counts;
}

TEST(LandmarkBudget, KeepsAllWithoutALimit) {
  const Views views = {{{0, 0}, {1, 0}}, {{1, 3}, {2, 3}}};
  EXPECT_EQ(select_landmarks(views, 3, 0), (std::vector<std::uint32_t>{0, 1, 2}));
}

TEST(LandmarkBudget, PrefersWhatManyViewsSee) {
  const Views views = {{{0, 0}, {1, 1}, {2, 2}}, {{1, 0}, {2, 1}}, {{2, 0}}};
  EXPECT_EQ(select_landmarks(views, 3, 1), (std::vector<std::uint32_t>{2}));
  EXPECT_EQ(select_landmarks(views, 3, 2), (std::vector<std::uint32_t>{1, 2}));
}

TEST(LandmarkBudget, GivesEachViewItsShare) {
  // One rich place seen by three views, one poor place seen by two: by observations alone the poor one would get nothing.
  Views views(5);
  for (std::uint32_t i = 0; i < 300; ++i) {
    for (std::size_t v = 0; v < 3; ++v) views[v].push_back({i, static_cast<std::uint8_t>(i % kNumCells)});
  }
  for (std::uint32_t i = 300; i < 400; ++i) {
    for (std::size_t v = 3; v < 5; ++v) views[v].push_back({i, static_cast<std::uint8_t>(i % kNumCells)});
  }
  const auto kept = select_landmarks(views, 400, 100);
  ASSERT_EQ(kept.size(), 100U);
  EXPECT_GE(kept_per_view(views, kept)[3], 8);
  EXPECT_GE(kept_per_view(views, kept)[0], 60);
}

TEST(LandmarkBudget, SpreadsOverTheImage) {
  Views views(1);
  for (std::uint32_t i = 0; i < 200; ++i) views[0].push_back({i, static_cast<std::uint8_t>(i < 190 ? 0 : 5)});  // crowded and empty cells
  const auto kept = select_landmarks(views, 200, 20);
  EXPECT_EQ(std::count_if(kept.begin(), kept.end(), [](std::uint32_t i) { return i >= 190; }), 10);
}

TEST(LandmarkBudget, TakesSingleObservationsOnlyWhereAViewNeedsThem) {
  Views views(4);
  for (std::uint32_t i = 0; i < 70; ++i) views[0].push_back({i, 0}), views[1].push_back({i, 0});  // seen twice
  for (std::uint32_t i = 70; i < 100; ++i) views[0].push_back({i, 1});                            // once, in a rich view
  for (std::uint32_t i = 100; i < 110; ++i) views[2].push_back({i, 0});                           // once, in a poor view
  EXPECT_EQ(kept_per_view(views, select_landmarks(views, 110, 0)), (std::vector<int>{70, 70, 10, 0}));
}

TEST(LandmarkBudget, StopsWhenEveryViewHasEnough) {
  Views views(2);
  for (std::uint32_t i = 0; i < 1500; ++i) views[0].push_back({i, 0}), views[1].push_back({i, 0});
  EXPECT_EQ(select_landmarks(views, 1500, 0).size(), 1000U);
}

/// Lazy evaluation must give what the plain greedy gives.
TEST(LandmarkBudget, EqualsThePlainGreedy) {
  std::mt19937 random(5);
  constexpr std::uint32_t kLandmarks = 120;
  Views views(12);
  for (auto& view : views) {
    for (std::uint32_t i = 0; i < kLandmarks; ++i) {
      if (random() % 4 == 0) view.push_back({i, static_cast<std::uint8_t>(random() % kNumCells)});
    }
  }
  std::vector<std::vector<int>> counts(views.size(), std::vector<int>(kNumCells, 0));
  std::vector<std::uint32_t> plain_greedy;
  for (int round = 0; round < 40; ++round) {
    double best_gain = -1;
    std::uint32_t best = 0;
    for (std::uint32_t i = 0; i < kLandmarks; ++i) {
      if (std::find(plain_greedy.begin(), plain_greedy.end(), i) != plain_greedy.end()) continue;
      double gain = 0;
      for (std::size_t v = 0; v < views.size(); ++v) {
        for (const auto& o : views[v]) {
          if (o.landmark == i) gain += std::sqrt(counts[v][o.cell] + 1.0) - std::sqrt(static_cast<double>(counts[v][o.cell]));
        }
      }
      if (gain > best_gain) best_gain = gain, best = i;
    }
    plain_greedy.push_back(best);
    for (std::size_t v = 0; v < views.size(); ++v) {
      for (const auto& o : views[v]) counts[v][o.cell] += o.landmark == best ? 1 : 0;
    }
  }
  std::sort(plain_greedy.begin(), plain_greedy.end());
  EXPECT_EQ(select_landmarks(views, kLandmarks, 40), plain_greedy);
}

}  // namespace
}  // namespace camloc
