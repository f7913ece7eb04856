// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Points files in other axes and units are recognised; good ones and mere noise are not accused.
#include <gtest/gtest.h>

#include <vector>

#include "tools/mapping/site/consensus.h"

namespace camloc::mapping {
namespace {

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::vector<PointPair> pairs() {
  const Rigid3 T{exp_so3({0, 0, 0.7}), {100, 200, 50}};
  std::vector<PointPair> pairs;
  for (int i = 0; i < 6; ++i) {
    const Eigen::Vector3d p(5 * std::cos(2.4 * i), 4 * std::sin(2.4 * i), 0.5 * (i * 5 % 6));
    pairs.push_back({T * p, p, 0.01});
  }
  return pairs;
}

const Eigen::Vector3d kUp(0.05, 0, 1);

TEST(AxisCheck, NothingIsExplainedWhereNothingIsWrong) {
  const auto good = pairs();
  EXPECT_EQ(explain_misfit(good, good.size(), 0.1, kUp), "");
  EXPECT_EQ(explain_upside_down(good, align_rigid(good), kUp), "");
  EXPECT_EQ(check_up(align_rigid(good).T_a_b, kUp), "");
}

TEST(AxisCheck, AxesAndUnitsAreNamed) {
  auto swapped = pairs();
  for (PointPair& pair : swapped) std::swap(pair.p_a.x(), pair.p_a.y());
  EXPECT_TRUE(contains(explain_misfit(swapped, 3, 0.1, kUp), "with x and y swapped"));
  EXPECT_TRUE(contains(explain_misfit(swapped, 3, 0.1, std::nullopt), "two axes swapped or one of them turned over"));
  auto millimetres = pairs();
  for (PointPair& pair : millimetres) pair.p_a *= 1000;
  EXPECT_TRUE(contains(explain_misfit(millimetres, 0, 0.1, kUp), "taken as millimetres"));
}

TEST(AxisCheck, ASiteWhoseZIsNotUpIsTold) {
  const Rigid3 lying{Eigen::Quaterniond(Eigen::AngleAxisd(-M_PI / 2, Eigen::Vector3d::UnitX())), {0, 0, 0}};
  EXPECT_TRUE(contains(check_up(lying, Eigen::Vector3d::UnitZ()), "up in the map is +y"));
  auto flat = pairs();
  for (PointPair& pair : flat) pair.p_b.z() = 0, pair.p_a.z() = 50;
  EXPECT_EQ(explain_upside_down(flat, align_rigid(flat), kUp), "");
  for (PointPair& pair : flat) std::swap(pair.p_a.x(), pair.p_a.y());
  EXPECT_TRUE(contains(explain_upside_down(flat, align_rigid(flat), kUp), "upside down"));
}

}  // namespace
}  // namespace camloc::mapping
