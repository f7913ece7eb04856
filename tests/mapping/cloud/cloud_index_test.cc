// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/mapping/cloud/cloud_index.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace camloc::mapping {
namespace {

/// A floor of 10 x 10 m, a point every 2 cm.
std::vector<Eigen::Vector3f> scanned_floor() {
  std::vector<Eigen::Vector3f> cloud;
  for (int i = 0; i <= 500; ++i) {
    for (int k = 0; k <= 500; ++k) cloud.emplace_back(0.02F * static_cast<float>(i), 0.02F * static_cast<float>(k), 0.0F);
  }
  return cloud;
}

TEST(CloudIndexTest, FindsNeighborsAndPlanes) {
  const auto cloud_m = scanned_floor();
  CloudIndex cloud(cloud_m);
  const auto neighbor = cloud.nearest({5.004, 5.003, 0.3}, 10);
  ASSERT_TRUE(neighbor);
  EXPECT_NEAR((cloud_m[neighbor->index].cast<double>() - Eigen::Vector3d(5, 5, 0)).norm(), 0, 1e-5);
  EXPECT_FALSE(cloud.nearest({5, 5, 0.3}, 0.29));
  EXPECT_FALSE(cloud.nearest({std::nan(""), 0, 0}, 10));
  EXPECT_TRUE(cloud.plane_at(neighbor->index).is_flat);
  EXPECT_NEAR(std::abs(cloud.plane_at(neighbor->index).normal.z()), 1, 1e-6);
  const std::vector<Eigen::Vector3f> none, one{{1, 2, 3}};
  EXPECT_FALSE(CloudIndex(none).nearest({0, 0, 0}, 1e9));
  CloudIndex single(one);
  EXPECT_FALSE(single.plane_at(0).is_flat);
  EXPECT_TRUE(single.plane_at(0).normal.allFinite());
}

TEST(CloudIndexTest, IsAsFarAsTheNearestOfAll) {
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 500; ++i)
    points.emplace_back(static_cast<float>(i * 37 % 101), static_cast<float>(i * 53 % 97), static_cast<float>(i * 71 % 89));
  const CloudIndex cloud(points);
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d p(2.3 * i - 10, 90 - 1.7 * i, 1.1 * i);
    double nearest_m = 1e9;
    for (const Eigen::Vector3f& q : points) nearest_m = std::min(nearest_m, (q.cast<double>() - p).norm());
    const auto found = cloud.nearest(p, 1e9);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->distance_m, nearest_m, 1e-5);
  }
}

// Two sheets at right angles: the plane is that of the sheet the point lies on, and at the edge there is none.
TEST(CloudIndexTest, PlanesBelongToTheirSheet) {
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i <= 50; ++i) {
    for (int k = 0; k <= 50; ++k) {
      points.emplace_back(0.02F * static_cast<float>(i), 0.02F * static_cast<float>(k), 0.0F);
      points.emplace_back(0.0F, 0.02F * static_cast<float>(k), 0.02F * static_cast<float>(i));
    }
  }
  CloudIndex cloud(points);
  const auto plane_near = [&](const Eigen::Vector3d& p) { return cloud.plane_at(cloud.nearest(p, 1)->index); };
  EXPECT_GT(std::abs(plane_near({0.5, 0.5, 0}).normal.z()), 0.999);
  EXPECT_GT(std::abs(plane_near({0, 0.5, 0.5}).normal.x()), 0.999);
  EXPECT_TRUE(plane_near({0, 0.5, 0.5}).is_flat);
  EXPECT_FALSE(plane_near({0, 0.5, 0}).is_flat);
}

}  // namespace
}  // namespace camloc::mapping
