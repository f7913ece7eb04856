// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/base/number_table.h"

#include <gtest/gtest.h>

namespace camloc {
namespace {

struct Numbers {
  double radius_m = 2.5;
  int max_places = 6;
  std::uint32_t min_inliers = 20;
};

constexpr NumberEntry<Numbers> kTable[] = {
    {"radius_m", "m", &Numbers::radius_m, "test"},
    {"max_places", "places", &Numbers::max_places, "test"},
    {"min_inliers", "inliers", &Numbers::min_inliers, "test"},
};

Status set(const char* assignment, Numbers* numbers) { return set_number<Numbers>(kTable, assignment, numbers); }

TEST(NumberTable, SetsTheNamedFieldAlone) {
  Numbers numbers;
  EXPECT_TRUE(set("radius_m=0.75", &numbers).is_ok());
  EXPECT_TRUE(set("min_inliers=30", &numbers).is_ok());
  EXPECT_TRUE(set("max_places=-1", &numbers).is_ok());
  EXPECT_EQ(numbers.radius_m, 0.75);
  EXPECT_EQ(numbers.min_inliers, 30U);
  EXPECT_EQ(numbers.max_places, -1);
  EXPECT_EQ(number_of(kTable[1], numbers), -1);
}

TEST(NumberTable, RefusesWhatTheFieldCannotHoldAndChangesNothing) {
  for (const char* wrong : {"radius_m", "radius_m=", "radius_m=x", "radius_m=1x", "radius_m=nan", "radius_m=inf", "min_inliers=-1",
                            "min_inliers=2.5", "max_places=1e12", "", "=3"}) {
    Numbers numbers;
    EXPECT_EQ(set(wrong, &numbers).code(), ErrorCode::kInvalid) << wrong;
    EXPECT_EQ(numbers.radius_m, 2.5);
    EXPECT_EQ(numbers.max_places, 6);
    EXPECT_EQ(numbers.min_inliers, 20U);
  }
}

TEST(NumberTable, AnUnknownNameListsTheKnownOnes) {
  Numbers numbers;
  const Status status = set("radios_m=3", &numbers);
  EXPECT_NE(status.message().find("radius_m, max_places, min_inliers"), std::string::npos) << status.message();
}

}  // namespace
}  // namespace camloc
