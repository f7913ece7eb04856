// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/localize/localization.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace camloc {
namespace {

TEST(Localization, EveryNameIsItsOwn) {
  std::set<std::string> names;
  for (int i = 0; i <= static_cast<int>(State::kCoasting); ++i) EXPECT_TRUE(names.insert(to_string(static_cast<State>(i))).second) << i;
  for (int i = 0; i <= static_cast<int>(Reason::kNoParallax); ++i) EXPECT_TRUE(names.insert(to_string(static_cast<Reason>(i))).second) << i;
  for (int i = 0; i < kNumStages; ++i) EXPECT_TRUE(names.insert(to_string(static_cast<Stage>(i))).second) << i;
  EXPECT_EQ(names.count("unknown") + names.count("UNKNOWN"), 0U);
}

TEST(Localization, NoReasonIsNoText) {
  EXPECT_STREQ(to_string(Reason::kNone), "");
  EXPECT_STREQ(to_string(State::kLocalized), "LOCALIZED");
}

TEST(Localization, ValuesFromOutsideHaveAName) {
  EXPECT_STREQ(to_string(static_cast<State>(200)), "UNKNOWN");
  EXPECT_STREQ(to_string(static_cast<Reason>(200)), "unknown");
  EXPECT_STREQ(to_string(static_cast<Stage>(200)), "unknown");
}

TEST(Localization, StartsWithNothing) {
  const Localization result;
  EXPECT_EQ(result.state, State::kLost);
  EXPECT_EQ(result.reason, Reason::kNotStarted);
  EXPECT_FALSE(result.has_pose);
  EXPECT_EQ(result.quality, -1);
  EXPECT_EQ(result.covariance.norm(), 0);
}

}  // namespace
}  // namespace camloc
