// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What is believed after what came before: thin and strong evidence, seconds and minutes after the last pose, in the right place and
// elsewhere.
#include "core/localize/gate.h"

#include <gtest/gtest.h>

namespace camloc {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

Candidate at(double x_m, std::uint32_t num_inliers, bool is_continuation = false) {
  Candidate candidate;
  candidate.evidence.is_found = true;
  candidate.evidence.T_map_camera.translation = {x_m, 0, 0};
  candidate.evidence.covariance = 1e-4 * Matrix6d::Identity();
  candidate.evidence.num_inliers = num_inliers;
  candidate.is_continuation = is_continuation;
  candidate.reason = Reason::kNone;
  return candidate;
}

/// A gate that believed a pose at the origin at time 0.
Gate gate_at_origin() {
  Gate gate(LocalizerNumbers{}, true);
  EXPECT_EQ(gate.judge(0, at(0, 200)), Reason::kNone);
  gate.accept(0, at(0, 200));
  return gate;
}

TEST(Gate, BelievesAnythingVerifiedAtFirst) {
  Gate gate(LocalizerNumbers{}, true);
  EXPECT_EQ(gate.judge(0, at(17, 25)), Reason::kNone);
  EXPECT_FALSE(gate.predict(0));
}

TEST(Gate, ThinEvidenceElsewhereWaitsUntilTheLossIsLongAgo) {
  for (const auto& [seconds, expected] :
       {std::pair{4, Reason::kImplausibleMotion}, std::pair{6, Reason::kImplausibleMotion}, std::pair{30, Reason::kImplausibleMotion},
        std::pair{59, Reason::kImplausibleMotion}, std::pair{61, Reason::kNone}}) {
    Gate gate = gate_at_origin();
    EXPECT_EQ(gate.judge(seconds * kSecond, at(40, 30)), expected) << seconds;
  }
}

TEST(Gate, ThinEvidenceWhereMotionExpectsItIsBelievedForAFewSeconds) {
  Gate gate = gate_at_origin();
  EXPECT_EQ(gate.judge(4 * kSecond, at(0.5, 30)), Reason::kNone);
  EXPECT_EQ(gate.judge(6 * kSecond, at(0.0, 30)), Reason::kImplausibleMotion);
}

TEST(Gate, StrongEvidenceMayBeWhereACameraCanGo) {
  Gate gate = gate_at_origin();
  EXPECT_EQ(gate.judge(kSecond, at(3.2, 100)), Reason::kNone);
  EXPECT_EQ(gate.judge(kSecond, at(3.3, 100)), Reason::kImplausibleMotion);
  EXPECT_EQ(gate.judge(20 * kSecond, at(59, 100)), Reason::kNone);
}

TEST(Gate, StrongEvidenceElsewhereIsBelievedWhenItStays) {
  Gate gate = gate_at_origin();
  for (std::int64_t i = 1; i <= 40; ++i) {
    const std::int64_t stamp_ns = i * kSecond / 30;
    const bool is_long_enough = i - 1 >= 30;
    EXPECT_EQ(gate.judge(stamp_ns, at(40, 100)), is_long_enough ? Reason::kNone : Reason::kImplausibleMotion) << i;
  }
  Gate interrupted = gate_at_origin();
  for (std::int64_t i = 1; i <= 40; ++i)
    EXPECT_EQ(interrupted.judge(i * kSecond / 30, at(i % 2 == 0 ? 40 : 80, 100)), Reason::kImplausibleMotion);
}

TEST(Gate, ThinEvidenceElsewhereIsBelievedWhenItStaysForLonger) {
  Gate gate = gate_at_origin();
  for (std::int64_t i = 1; i <= 70; ++i) {
    const bool is_long_enough = i - 1 >= 60;
    EXPECT_EQ(gate.judge(2 * kSecond + i * kSecond / 30, at(40, 30)), is_long_enough ? Reason::kNone : Reason::kImplausibleMotion) << i;
  }
}

// A recording with a piece left out: after the gap the velocity of before says nothing, and thin evidence may be wherever a camera can
// have gone meanwhile.
TEST(Gate, ThinEvidenceAfterAGapIsBelievedWhereACameraCanBe) {
  Gate gate = gate_at_origin();
  gate.accept(kSecond / 30, at(0.01, 100, true));
  EXPECT_EQ(gate.judge(2 * kSecond / 30, at(0.4, 25)), Reason::kImplausibleMotion) << "no gap";
  EXPECT_EQ(gate.judge(kSecond / 2, at(1.2, 25)), Reason::kNone);
  EXPECT_EQ(gate.judge(kSecond / 2, at(2.5, 25)), Reason::kImplausibleMotion) << "nobody runs like that";
}

TEST(Gate, ATrackedPoseThatARivalOvertakesIsGivenUp) {
  Gate gate = gate_at_origin();
  for (int i = 1; i <= 40; ++i) {
    Rigid3 T_map_rival;
    T_map_rival.translation.x() = 0.1 * i + 20;
    EXPECT_TRUE(gate.withstands(at(0.1 * i, 100, true), T_map_rival, i % 2 == 0 ? 5 : 1));
    gate.accept(i * kSecond / 10, at(0.1 * i, 100, true));
  }
  int num_withstood = 0;
  for (int i = 41; i <= 80; ++i, ++num_withstood) {
    Rigid3 T_map_rival;
    T_map_rival.translation.x() = 0.1 * i + 20;
    if (!gate.withstands(at(0.1 * i, 100, true), T_map_rival, -9)) break;
    gate.accept(i * kSecond / 10, at(0.1 * i, 100, true));
  }
  EXPECT_GT(num_withstood, 5) << "not at once";
  EXPECT_LT(num_withstood, 15);
  EXPECT_FALSE(gate.predict(9 * kSecond, 100 * kSecond)) << "the motion is forgotten";
}

TEST(Gate, WhoKnowsBetterMayContradictTheMotion) {
  Gate gate = gate_at_origin();
  Candidate hinted = at(40, 100);
  hinted.overrides_motion = true;
  EXPECT_EQ(gate.judge(kSecond / 30, hinted), Reason::kNone);
  hinted.reason = Reason::kFewInliers;
  EXPECT_EQ(gate.judge(kSecond / 30, hinted), Reason::kFewInliers) << "but not verification";
}

TEST(Gate, PlacesThatLookedAlikeStayDoubtfulForAMoment) {
  Gate gate = gate_at_origin();
  Candidate ambiguous = at(0, 100);
  ambiguous.reason = Reason::kAmbiguous;
  EXPECT_EQ(gate.judge(70 * kSecond, ambiguous), Reason::kAmbiguous);
  EXPECT_EQ(gate.judge(70 * kSecond + kSecond / 2, at(0, 30)), Reason::kAmbiguous) << "thin";
  EXPECT_EQ(gate.judge(70 * kSecond + kSecond / 2, at(0, 90)), Reason::kNone) << "strong";
  EXPECT_EQ(gate.judge(71 * kSecond + 1, at(0, 30)), Reason::kNone) << "a second later";
}

TEST(Gate, DoubtsAThinTrackedPoseThatLostMostOfTheLast) {
  Gate gate = gate_at_origin();  // 200 inliers
  EXPECT_TRUE(gate.is_doubtful(at(0, 30, true)));
  EXPECT_FALSE(gate.is_doubtful(at(0, 30))) << "the whole map was asked already";
  EXPECT_FALSE(gate.is_doubtful(at(0, 90, true))) << "strong enough by itself";
  gate.accept(kSecond / 10, at(0, 30, true));
  EXPECT_FALSE(gate.is_doubtful(at(0, 28, true))) << "it has been like this for a while";
  EXPECT_TRUE(gate.is_doubtful(at(0, 14, true)));
}

TEST(Gate, SaysHowFarAJumpWent) {
  Gate gate = gate_at_origin();
  EXPECT_EQ(gate.accept(kSecond / 10, at(0.01, 100, true)), 0) << "a continuation";
  EXPECT_NEAR(gate.accept(2 * kSecond, at(5, 100)), 5 - 0.01 - 0.05, 1e-6) << "from where it was predicted";
}

TEST(Gate, PredictsForAsLongAsThatIsWorthAnything) {
  Gate gate = gate_at_origin();
  ASSERT_TRUE(gate.predict(kSecond));
  EXPECT_EQ(gate.predict(kSecond)->T_map_camera.translation.x(), 0);
  EXPECT_FALSE(gate.predict(kSecond + 1));
  EXPECT_TRUE(gate.predict(kSecond / 2, kSecond / 2));
  EXPECT_FALSE(gate.predict(kSecond / 2 + 1, kSecond / 2));
}

TEST(Gate, AClockThatRunsBackwardsEndsWhatWasKnown) {
  Gate gate = gate_at_origin();
  gate.accept(kSecond, at(0, 100, true));
  gate.begin(kSecond + 1);
  EXPECT_TRUE(gate.predict(kSecond + 1));
  gate.begin(kSecond);
  EXPECT_FALSE(gate.predict(kSecond));
  EXPECT_EQ(gate.judge(kSecond, at(99, 25)), Reason::kNone);
}

TEST(Gate, WithoutMemoryEveryFrameIsTheFirst) {
  Gate gate(LocalizerNumbers{}, false);
  gate.accept(0, at(0, 100));
  gate.begin(kSecond / 30);
  EXPECT_FALSE(gate.predict(kSecond / 30));
  EXPECT_EQ(gate.judge(kSecond / 30, at(50, 25)), Reason::kNone);
}

}  // namespace
}  // namespace camloc
