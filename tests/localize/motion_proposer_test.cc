// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/localize/motion_proposer.h"

#include <gtest/gtest.h>

#include "tests/localize/sample_world.h"

namespace camloc {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

struct Asked {
  LocalizerNumbers numbers;
  Gate gate{numbers, true};
  FrameFeatures view;
  MotionProposer proposer{{&testing::SampleWorld::get().map(), &testing::SampleWorld::get().camera(), &numbers, 1000}};

  std::span<const Proposal> at(std::int64_t stamp_ns) { return proposer.propose({stamp_ns, &view, &gate}); }
  void believe(std::int64_t stamp_ns, double x_m) {
    Candidate pose;
    pose.evidence.T_map_camera.translation.x() = x_m;
    pose.evidence.covariance = 1e-6 * Matrix6d::Identity();
    pose.is_continuation = stamp_ns > 0;
    gate.accept(stamp_ns, pose);
  }
};

TEST(MotionProposer, KnowsNothingAtFirstAndNothingAfterASecond) {
  Asked asked;
  EXPECT_TRUE(asked.at(0).empty());
  asked.believe(0, 1);
  EXPECT_EQ(asked.at(kSecond).size(), 1U);
  EXPECT_TRUE(asked.at(kSecond + 1).empty());
}

TEST(MotionProposer, ProposesWhereTheMotionLeads) {
  Asked asked;
  asked.believe(0, 1.0);
  asked.believe(kSecond / 10, 1.1);
  const auto proposals = asked.at(2 * kSecond / 10);
  ASSERT_EQ(proposals.size(), 1U);
  EXPECT_NEAR(proposals[0].T_map_camera.translation.x(), 1.2, 1e-9);
  EXPECT_TRUE(proposals[0].is_continuation);
  EXPECT_FALSE(proposals[0].overrides_motion);
  EXPECT_EQ(proposals[0].num_keyframes, 0);
}

TEST(MotionProposer, LooksWiderTheLongerItHasSeenNothing) {
  Asked asked;
  asked.believe(0, 1.0);
  const float soon = asked.at(kSecond / 30)[0].radius_px, late = asked.at(kSecond / 4)[0].radius_px;
  EXPECT_GE(soon, 15.0F);
  EXPECT_GT(late, soon);
  EXPECT_LE(asked.at(kSecond)[0].radius_px, 0.15 * testing::SampleWorld::get().camera().color.mean_focal_px() + 0.01) << "a bound";
}

}  // namespace
}  // namespace camloc
