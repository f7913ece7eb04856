// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/map/map_ranges.h"

#include <gtest/gtest.h>

#include <limits>

namespace camloc::map_ranges {
namespace {

TEST(MapRanges, PoseSigmas) {
  EXPECT_TRUE(are_pose_sigmas(0, 0));
  EXPECT_TRUE(are_pose_sigmas(1000, 3.14));
  EXPECT_FALSE(are_pose_sigmas(1000.1, 0));
  EXPECT_FALSE(are_pose_sigmas(0, 3.15));
  EXPECT_FALSE(are_pose_sigmas(-1e-9, 0));
  EXPECT_FALSE(are_pose_sigmas(0, -1e-9));
  EXPECT_FALSE(are_pose_sigmas(std::numeric_limits<double>::quiet_NaN(), 0));
}

TEST(MapRanges, ACovarianceIsPositiveSemiDefiniteWhateverTheUnits) {
  EXPECT_TRUE(is_covariance(Matrix6d::Zero(), 1)) << "a datum that is exact";
  Matrix6d mixed = Matrix6d::Identity();
  mixed.bottomRightCorner<3, 3>() *= 1e-10;
  EXPECT_TRUE(is_covariance(mixed, 1));
  mixed(0, 4) = mixed(4, 0) = 0.99e-5;
  EXPECT_TRUE(is_covariance(mixed, 1));
  mixed(0, 4) = mixed(4, 0) = 1.02e-5;  // small against the metres, and still a correlation above 1
  EXPECT_FALSE(is_covariance(mixed, 1));
}

TEST(MapRanges, EachFlawOfACovarianceAloneIsSeen) {
  const auto spoilt = [](int row, int column, double value) {
    Matrix6d covariance = Matrix6d::Identity();
    covariance(row, column) = value;
    return covariance;
  };
  EXPECT_FALSE(is_covariance(spoilt(2, 2, -1e-6), 2));
  EXPECT_FALSE(is_covariance(spoilt(2, 2, 4.1), 2)) << "a sigma of more than 2 m";
  EXPECT_FALSE(is_covariance(spoilt(5, 5, 9.9), 2)) << "a sigma of more than half a turn";
  EXPECT_TRUE(is_covariance(spoilt(5, 5, 9.8), 2));
  EXPECT_FALSE(is_covariance(spoilt(0, 1, 0.1), 2)) << "not symmetric";
  EXPECT_FALSE(is_covariance(spoilt(0, 1, std::numeric_limits<double>::quiet_NaN()), 2));
  Matrix6d flat = Matrix6d::Identity();
  flat(3, 3) = 0;
  EXPECT_TRUE(is_covariance(flat, 2));
  flat(0, 3) = flat(3, 0) = 1e-20;
  EXPECT_TRUE(is_covariance(flat, 2)) << "rounding";
  flat(0, 3) = flat(3, 0) = 1e-3;
  EXPECT_FALSE(is_covariance(flat, 2)) << "what never varies varies with nothing";
}

}  // namespace
}  // namespace camloc::map_ranges
