// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/mapping/site/consensus.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/geometry/generated.h"

namespace camloc::mapping {
namespace {

std::vector<PointPair> survey(int count) {
  std::mt19937 rng(1);
  const Rigid3 T{exp_so3({0.01, -0.02, 0.7}), {456789, 5432109, 345}};
  std::vector<PointPair> pairs;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d p(10 * std::cos(2.4 * i), 6 * std::sin(2.4 * i), 0.3 + 2.2 * (i * 37 % 11) / 10.0);
    pairs.push_back({T * p + testing::random_vector(rng, 0.01), p, 0.01});
  }
  return pairs;
}

TEST(ConsensusTest, IsDeterministicAlsoWhereItSamples) {
  std::vector<PointPair> pairs = survey(60);
  for (std::size_t i = 0; i < 60; i += 3) pairs[i].p_a.x() += 1 + 0.3 * static_cast<double>(i);
  const Consensus a = find_consensus(pairs, 0.1), b = find_consensus(pairs, 0.1);
  EXPECT_EQ(a.is_inlier, b.is_inlier);
  EXPECT_EQ(a.num_inliers, 40U);
  EXPECT_FALSE(a.is_ambiguous);
  EXPECT_TRUE(find_consensus({}, 0.1).is_inlier.empty());
}

TEST(ConsensusTest, OneWrongPairIsTheOutlier) {
  std::vector<PointPair> pairs = survey(7);
  pairs[4].p_a.y() += 2;
  const Consensus consensus = find_consensus(pairs, 0.1);
  ASSERT_EQ(consensus.is_inlier.size(), 7U);
  for (std::size_t i = 0; i < 7; ++i) EXPECT_EQ(consensus.is_inlier[i], i != 4) << i;
  EXPECT_LT(consensus.rms_m, 0.03);
  EXPECT_FALSE(consensus.is_ambiguous);
}

// Of four points in a plane each may be the one with the wrong height.
TEST(ConsensusTest, SaysWhenItCannotBeTold) {
  std::vector<PointPair> pairs;
  for (const Eigen::Vector3d& p : {Eigen::Vector3d(0, 0, 0), {8, 0, 0}, {8, 6, 0}, {0, 6, 0}}) pairs.push_back({p, p, 0.01});
  pairs[2].p_a.z() += 1;
  const Consensus consensus = find_consensus(pairs, 0.1);
  EXPECT_TRUE(consensus.is_ambiguous);
  EXPECT_EQ(consensus.num_inliers, 3U);
}

}  // namespace
}  // namespace camloc::mapping
