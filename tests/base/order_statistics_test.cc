// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/base/order_statistics.h"

#include <gtest/gtest.h>

namespace camloc {
namespace {

TEST(OrderStatistics, UpperMedian) {
  EXPECT_EQ(upper_median<double>({}), 0.0);
  EXPECT_EQ(upper_median<double>({3, 1, 2}), 2.0);
  EXPECT_EQ(upper_median<float>({4, 1, 3, 2}), 3.0F);
}

TEST(OrderStatistics, LowerQuantile) {
  EXPECT_EQ(lower_quantile<double>({}, 0.5), 0.0);
  const std::vector<double> values = {5, 1, 4, 2, 3};
  EXPECT_EQ(lower_quantile(values, 0.0), 1.0);
  EXPECT_EQ(lower_quantile(values, 0.5), 3.0);
  EXPECT_EQ(lower_quantile(values, 0.99), 4.0);
  EXPECT_EQ(lower_quantile(values, 1.0), 5.0);
}

}  // namespace
}  // namespace camloc
