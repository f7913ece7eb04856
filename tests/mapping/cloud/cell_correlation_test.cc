// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tests/mapping/scanned_flat.h"
#include "tools/mapping/cloud/cloud_index.h"

namespace camloc::mapping {
namespace {

TEST(CellGridTest, FindsWhereAPieceBelongs) {
  Random random(1);
  std::vector<Eigen::Vector3d> points, piece;
  for (int i = 0; i < 400; ++i) points.emplace_back(random.uniform(-10, 10), random.uniform(-8, 8), random.uniform(0, 3));
  for (const auto& p : points)
    if (p.x() > 2) piece.push_back(p - Eigen::Vector3d(7, -20, 100));
  const CellGrid grid(points, 0.25, 1000000);
  const auto places = grid.best_places(piece, 4);
  ASSERT_EQ(places.size(), 4U);
  EXPECT_LT((places[0].translation_m - Eigen::Vector3d(7, -20, 100)).cwiseAbs().maxCoeff(), 0.26);
  EXPECT_GT(places[0].share, 2 * places[1].share);
  EXPECT_EQ(CellGrid(points, 0.25, 1000).cell_m() > 0.5, true);
  EXPECT_TRUE(grid.best_places({}, 3).empty());
}

}  // namespace
}  // namespace camloc::mapping
