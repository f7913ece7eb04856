// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/mapping/cloud/point_cloud.h"

#include <gtest/gtest.h>

#include <cmath>

namespace camloc::mapping {
namespace {

TEST(CloudAccumulator, KeepsTheMeanOfAVoxel) {
  CloudAccumulator accumulator({0.1, 1, 2});
  for (const double x : {0.01, 0.03, 0.05, 7.5}) accumulator.add({1000000 + x, 0.05, 0.05});  // the last is alone
  const PointCloud cloud = accumulator.finish();
  ASSERT_EQ(cloud.points_m.size(), 1U);
  EXPECT_NEAR(cloud.origin_m.x() + static_cast<double>(cloud.points_m[0].x()), 1000000.03, 1e-5);
}

TEST(CloudAccumulator, IsTheSameThroughManyCompactions) {
  // More points than fit between two compactions, in another order than their voxels.
  CloudAccumulator accumulator({1.0, 1, 1});
  std::uint64_t state = 1;
  for (int i = 0; i < 3000000; ++i) {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    accumulator.add({static_cast<double>((state >> 33) % 100) + 0.5, static_cast<double>((state >> 43) % 100) + 0.5, 0.5});
  }
  const PointCloud cloud = accumulator.finish();
  EXPECT_EQ(cloud.points_m.size(), 10000U);
  EXPECT_EQ(cloud.num_read, 3000000U);
  for (const Eigen::Vector3f& p : cloud.points_m) EXPECT_NEAR(p.x() - std::floor(p.x()), 0.5F, 1e-3F);
}

TEST(CloudAccumulator, IsNotMisledByAStrayFirstPoint) {
  CloudAccumulator accumulator({0.01, 1, 1});
  accumulator.add({0, 0, 0});
  for (int i = 0; i < 10000; ++i) accumulator.add({500000 + 0.02 * i, 5400000.123, 100});
  const PointCloud cloud = accumulator.finish();
  EXPECT_GT(cloud.origin_m.x(), 499000);
  const auto bounds = cloud.bounds_m();
  EXPECT_LT((bounds[1] - bounds[0]).norm(), 210);
  double worst = 0;
  for (const Eigen::Vector3f& p : cloud.points_m) {
    if (cloud.origin_m.x() + static_cast<double>(p.x()) > 1000)
      worst = std::max(worst, std::abs(cloud.origin_m.y() + static_cast<double>(p.y()) - 5400000.123));
  }
  EXPECT_LT(worst, 1e-5);
}

}  // namespace
}  // namespace camloc::mapping
