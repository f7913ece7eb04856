// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Pairs: capacity, ordering, no allocation.
#include "core/geometry/correspondences.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "tests/geometry/allocation_counter.h"

namespace camloc {
namespace {

Correspondences random_pairs(std::size_t n, int num_ranks) {
  std::mt19937 rng(1);
  Correspondences pairs(n);
  for (std::size_t i = 0; i < n; ++i) {
    const auto f = static_cast<float>(i);
    pairs.add(f, f + 0.1F, f + 0.2F, f + 0.3F, f + 0.4F, f + 0.5F, f + 0.6F, static_cast<float>(rng() % num_ranks),
              static_cast<std::int32_t>(i), -static_cast<std::int32_t>(i));
  }
  return pairs;
}

TEST(Correspondences, RefusesMoreThanItsCapacity) {
  Correspondences pairs = random_pairs(3, 10);
  EXPECT_EQ(pairs.size(), 3U);
  EXPECT_FALSE(pairs.add(0, 0, 0, 0, 0, 0, 0, 0, 7, 7));
  EXPECT_EQ(pairs.size(), 3U);
  pairs.clear();
  EXPECT_EQ(pairs.size(), 0U);
  EXPECT_EQ(pairs.capacity(), 3U);
  EXPECT_TRUE(pairs.add(0, 0, 0, 0, 0, 0, 0, 0, 7, 7));
  EXPECT_EQ(pairs.feature[0], 7);
}

TEST(Correspondences, SortsStablyAndKeepsPairsTogether) {
  Correspondences pairs = random_pairs(500, 20);
  std::vector<std::int32_t> expected(500);
  std::iota(expected.begin(), expected.end(), 0);
  const std::vector<float> rank = pairs.rank;
  std::stable_sort(expected.begin(), expected.end(), [&](auto a, auto b) { return rank[a] < rank[b]; });
  pairs.sort_by_rank();
  EXPECT_EQ(pairs.feature, expected);
  for (std::size_t i = 0; i < 500; ++i) {
    const auto f = static_cast<float>(pairs.feature[i]);
    EXPECT_EQ(pairs.landmark[i], -pairs.feature[i]);
    EXPECT_EQ(pairs.rank[i], rank[static_cast<std::size_t>(pairs.feature[i])]);
    const std::array<float, 7> expected_values{f, f + 0.1F, f + 0.2F, f + 0.3F, f + 0.4F, f + 0.5F, f + 0.6F};
    const std::array<float, 7> values{pairs.x[i], pairs.y[i], pairs.X[i], pairs.Y[i], pairs.Z[i], pairs.depth_m[i], pairs.sigma_px[i]};
    EXPECT_EQ(values, expected_values);
  }
}

TEST(Correspondences, SortsOnlyWhatWasAdded) {
  Correspondences pairs(10);
  pairs.sort_by_rank();
  pairs.add(1, 0, 0, 0, 0, 0, 0, 5, 0, 0);
  pairs.add(2, 0, 0, 0, 0, 0, 0, 3, 1, 1);
  pairs.sort_by_rank();
  EXPECT_EQ(pairs.x[0], 2.0F);
  EXPECT_EQ(pairs.x[1], 1.0F);
}

TEST(Correspondences, SortingAllocatesNothing) {
  if (!testing::can_count_allocations()) GTEST_SKIP() << "a sanitizer owns the allocator";
  Correspondences pairs = random_pairs(1000, 256);
  const std::uint64_t before = testing::num_allocations();
  pairs.sort_by_rank();
  EXPECT_EQ(testing::num_allocations(), before);
}

}  // namespace
}  // namespace camloc
