// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What a correction asks of the way walked.
#include "core/slam/dead_reckoning.h"

#include <gtest/gtest.h>

#include "tests/slam/true_keyframes.h"

namespace camloc {
namespace {

using testing::looking;

/// Ten keyframes a metre apart, all held by strong links; `second_segment_at` begins another segment there.
struct Way : testing::TrueKeyframes {
  DeadReckoning reckoning{SlamNumbers{}, &map};

  explicit Way(std::uint32_t second_segment_at = 10) : TrueKeyframes(testing::make_hall()) {
    for (std::uint32_t k = 0; k < 10; ++k) {
      add(looking({1.0 * k, 0, 1.5}, 0), k < second_segment_at ? 0 : 1);
      reckoning.note_bridged(k);
    }
  }
  [[nodiscard]] double drift_inconsistency_of(const Eigen::Vector3d& correction_m, std::uint32_t keyframe = 9,
                                              std::uint32_t place = 0) const {
    Rigid3 T = map.keyframe(keyframe).view.T_map_camera;
    T.translation += correction_m;
    return reckoning.drift_inconsistency(keyframe, place, T);
  }
};

TEST(DeadReckoning, DriftInconsistencyIsTheCorrectionInUnitsOfTheDriftOfTheWay) {
  const Way way;
  const SlamNumbers n;
  EXPECT_EQ(way.drift_inconsistency_of({0, 0, 0}), 0);
  EXPECT_NEAR(way.drift_inconsistency_of({0, n.loop_drift_m + 9 * n.loop_drift_per_m, 0}), 1, 1e-9);
  EXPECT_GT(way.drift_inconsistency_of({0, 0.3, 0}, 3, 0), way.drift_inconsistency_of({0, 0.3, 0}, 9, 0));  // less walked, less drift
  Rigid3 turned = way.map.keyframe(9).view.T_map_camera;
  turned.rotation = turned.rotation * exp_so3({0, 0, n.loop_drift_rad + 9 * n.loop_drift_rad_per_m});
  EXPECT_NEAR(way.reckoning.drift_inconsistency(9, 0, turned), 1, 1e-6);
}

TEST(DeadReckoning, AWeakLinkOnTheWayLoosensIt) {
  Way way;
  const double before = way.drift_inconsistency_of({0, 0.3, 0});
  way.reckoning.note_links(5);  // which shares nothing with any other
  EXPECT_LT(way.drift_inconsistency_of({0, 0.3, 0}), 0.9 * before);
}

TEST(DeadReckoning, APlaceIsInSightOnlyAsFarAsViewsReach) {
  const Way way;
  EXPECT_TRUE(way.reckoning.may_see(5, 0));
  EXPECT_FALSE(way.reckoning.may_see(9, 0));
}

// Tracking was lost for a second: the camera can have come 2 m in the meantime.
TEST(DeadReckoning, BetweenSegmentsTheTimeLostLimitsTheWay) {
  Way way(5);
  EXPECT_EQ(way.reckoning.begin_between(0, 7), nullptr);
  EXPECT_EQ(way.drift_inconsistency_of({-30, 0, 0}, 7, 2), 0);  // nothing is known
  way.reckoning.begin_segment({5, true, 4, Rigid3(), 1.0});
  ASSERT_NE(way.reckoning.begin_between(0, 7), nullptr);
  ASSERT_NE(way.reckoning.begin_between(7, 0), nullptr);
  EXPECT_EQ(way.drift_inconsistency_of({0.9, 0, 0}, 7, 2), 0);
  EXPECT_GT(way.drift_inconsistency_of({1.1, 0, 0}, 7, 2), DeadReckoning::kMaxDriftInconsistency);
}

TEST(DeadReckoning, AFewCommonLandmarksMakeALooseLink) {
  const Rigid3 step{Eigen::Quaterniond::Identity(), {1, 0, 0}};
  const double strong = link_covariance(step, 150).trace();
  EXPECT_EQ(link_covariance(step, 1000).trace(), strong);
  EXPECT_NEAR(link_covariance(step, 15).trace(), 100 * strong, 1e-6 * strong);
  EXPECT_NEAR(link_covariance(step, 0).trace(), 400 * strong, 1e-6 * strong);
}

}  // namespace
}  // namespace camloc
