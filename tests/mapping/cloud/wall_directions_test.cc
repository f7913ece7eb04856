// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tests/mapping/motions.h"
#include "tests/mapping/scanned_flat.h"
#include "tools/mapping/cloud/cloud_index.h"

namespace camloc::mapping {
namespace {

TEST(WallDirections, AreThoseOfTheRoom) {
  const ScannedFlat flat(2);
  const Rigid3 turn = motion({20, 30, 40}, {0, 0, 0});
  std::vector<Eigen::Vector3d> points;
  for (std::size_t i = 0; i < flat.cloud_m.size(); i += 7) points.push_back(turn * flat.cloud_m[i].cast<double>());
  const Eigen::Matrix3d axes = turn.rotation.toRotationMatrix().transpose() * wall_directions(points);
  EXPECT_NEAR(axes.determinant(), 1, 1e-9);
  for (int i = 0; i < 3; ++i) EXPECT_GT(axes.col(i).cwiseAbs().maxCoeff(), 0.9998) << axes;
}

TEST(WallDirections, WithoutSurfacesAreTheAxesOfThePoints) {
  Random random(4);
  const Rigid3 turn = motion({10, -20, 30}, {0, 0, 0});
  std::vector<Eigen::Vector3d> points;  // far apart, in a long and flat heap
  for (int i = 0; i < 300; ++i)
    points.push_back(turn * Eigen::Vector3d(random.uniform(-90, 90), random.uniform(-30, 30), random.uniform(-5, 5)));
  const Eigen::Matrix3d axes = turn.rotation.toRotationMatrix().transpose() * wall_directions(points);
  EXPECT_NEAR(axes.determinant(), 1, 1e-9);
  for (int i = 0; i < 3; ++i) EXPECT_GT(axes.col(i).cwiseAbs().maxCoeff(), 0.99) << axes;
}

}  // namespace
}  // namespace camloc::mapping
