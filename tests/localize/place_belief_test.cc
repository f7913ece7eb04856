// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What frames say adds up over time and distance, and nothing is counted twice.
#include "core/localize/place_belief.h"

#include <gtest/gtest.h>

#include <limits>

namespace camloc {
namespace {

constexpr std::int64_t kFrameNs = 100'000'000;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Rigid3 at(double x_m) { return {Eigen::Quaterniond::Identity(), {x_m, 0, 0}}; }

TEST(PlaceBelief, AsksForOddsThatTheRiskGives) {
  LocalizerNumbers numbers;
  numbers.max_wrong_place_risk = 0.001;
  EXPECT_NEAR(PlaceBelief(numbers).limit(), 6.907, 0.001);
  numbers.max_wrong_place_risk = 0.5;
  EXPECT_NEAR(PlaceBelief(numbers).limit(), 0, 1e-12);
}

TEST(PlaceBelief, AClaimStandsForAWhileBeforeItIsBelieved) {
  const LocalizerNumbers numbers;
  PlaceBelief belief(numbers);
  double odds = 0;
  for (std::int64_t i = 0; i <= 9; ++i) odds = belief.claim(i * kFrameNs, at(40), 1);
  EXPECT_NEAR(odds, 0.9 * belief.limit(), 1e-9);
  belief.forget_claims();
  EXPECT_EQ(belief.claim(10 * kFrameNs, at(40), 1), 0);
}

TEST(PlaceBelief, AThinClaimStandsForLonger) {
  PlaceBelief belief{LocalizerNumbers{}};
  double odds = 0;
  for (std::int64_t i = 0; i <= 10; ++i) odds = belief.claim(i * kFrameNs, at(40), 0.25);
  EXPECT_NEAR(odds, 0.25 * belief.limit(), 1e-9);
}

TEST(PlaceBelief, ClaimsOfDifferentPlacesSpeakAgainstEachOther) {
  PlaceBelief belief{LocalizerNumbers{}};
  for (std::int64_t i = 0; i < 100; ++i) EXPECT_LT(belief.claim(i * kFrameNs, at(i % 2 == 0 ? 40 : 80), 1), 0.2 * belief.limit()) << i;
  for (std::int64_t i = 0; i < 100; ++i)
    EXPECT_LT(belief.claim((200 + i) * kFrameNs, at(40.0 * static_cast<double>(i % 7)), 1), 0.2 * belief.limit()) << i;
}

TEST(PlaceBelief, AGapIsNoTimeThatAClaimStood) {
  const LocalizerNumbers numbers;
  PlaceBelief belief(numbers);
  EXPECT_EQ(belief.claim(0, at(40), 1), 0);
  const auto gap_ns = static_cast<std::int64_t>(0.9e9);
  EXPECT_NEAR(belief.claim(gap_ns, at(40), 1), numbers.max_confirmation_gap_s / numbers.confirmation_s * belief.limit(), 1e-9);
  EXPECT_EQ(belief.claim(5 * gap_ns, at(40), 1), 0) << "too long ago";
}

TEST(PlaceBelief, ARivalThatGainsEndsABelief) {
  PlaceBelief belief{LocalizerNumbers{}};
  EXPECT_GT(belief.challenge(at(0), at(20), -9), 0) << "no single view does";
  for (int i = 0; i < 100; ++i) EXPECT_GT(belief.challenge(at(0), at(20), -9), 0) << "and looking at it again says nothing new";
  EXPECT_GT(belief.challenge(at(0.3), at(20.3), -9), 0);
  EXPECT_LE(belief.challenge(at(0.6), at(20.6), -9), 0);
}

TEST(PlaceBelief, ARivalThatExplainsLessGainsNothing) {
  PlaceBelief belief{LocalizerNumbers{}};
  for (int i = 0; i < 100; ++i) EXPECT_EQ(belief.challenge(at(i), at(20 + i), i % 2 == 0 ? 3 : kInfinity), belief.limit());
  EXPECT_GT(belief.challenge(at(101), at(121), -9), 0) << "and has no credit from that";
}

TEST(PlaceBelief, RivalsAreWeighedEachOnItsOwn) {
  PlaceBelief belief{LocalizerNumbers{}};
  for (int i = 0; i < 40; ++i) {
    const double x = 0.6 * i;
    EXPECT_GT(belief.challenge(at(x), at(x + 20 + 4 * (i % 8)), i < 8 ? -4 : 4), 0) << i;
  }
  for (int i = 0; i < 400; ++i) EXPECT_GT(belief.challenge(at(30), at(100 + 2 * i), -9), 0) << "more than there is room for";
}

TEST(PlaceBelief, AContestIsRememberedForAMoment) {
  PlaceBelief belief{LocalizerNumbers{}};
  EXPECT_FALSE(belief.is_contested(0));
  belief.note_contest(5 * kFrameNs);
  EXPECT_TRUE(belief.is_contested(15 * kFrameNs));
  EXPECT_FALSE(belief.is_contested(15 * kFrameNs + 1));
}

}  // namespace
}  // namespace camloc
