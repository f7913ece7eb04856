// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/localize/pose_estimator.h"

#include <gtest/gtest.h>

#include "tests/localize/sample_world.h"

namespace camloc {
namespace {

using testing::SampleWorld;

constexpr std::uint64_t kIndex = 22;

class PoseEstimatorTest : public ::testing::Test {
 protected:
  void observe(const FrameBuffer& frame) {
    frame_ = frame;
    ASSERT_TRUE(observations_.observe(frame_.view()));
  }
  /// The frame seen again from its true pose.
  PoseHypothesis look_from_truth() {
    PoseHypothesis start;
    start.T_map_camera = truth_;
    return estimator_.look_again(observations_, start);
  }

  const SampleWorld& world_ = SampleWorld::get();
  const Rigid3 truth_ = sample_pose(kIndex);
  StageTimer timer_{nullptr};
  FrameBuffer frame_;
  FrameObservations observations_{world_.camera(), OrbOptions{}, true};
  PoseEstimator estimator_{world_.map(), world_.camera(), OrbOptions{}, PoseEstimatorOptions{}, &timer_};
};

TEST_F(PoseEstimatorTest, GuidedMatchesGiveThePose) {
  observe(world_.frame(kIndex));
  const auto matches = estimator_.match_around(observations_, truth_, 12);
  ASSERT_GT(matches.size(), 300U);
  const PoseHypothesis hypothesis = estimator_.from_matches(observations_, matches, 1);
  ASSERT_TRUE(hypothesis.is_found);
  EXPECT_LT(pose_error(truth_, hypothesis.T_map_camera).norm(), 0.02);
  EXPECT_EQ(hypothesis.num_matches, matches.size());
  const PoseHypothesis again = estimator_.look_again(observations_, hypothesis);
  ASSERT_TRUE(again.is_found);
  EXPECT_LT(pose_error(truth_, again.T_map_camera).norm(), 0.006);
  EXPECT_GE(again.num_inliers, hypothesis.num_inliers);
  EXPECT_LE(again.num_inliers, again.num_matches);
  EXPECT_LE(again.num_matches, again.num_visible);
  EXPECT_GT(again.spread, 0.6);
  EXPECT_GT(again.depth_agreement, 0.95);
  EXPECT_GT(again.map_depth_agreement, 0.95);
  EXPECT_LT(again.rms_px, 2);
  EXPECT_TRUE(again.has_focal_scale);
  EXPECT_NEAR(again.focal_scale, 1, 0.01);
}

TEST_F(PoseEstimatorTest, HalfOfTheMatchesMayBeWrong) {
  observe(world_.frame(kIndex));
  const auto right = estimator_.match_around(observations_, truth_, 12);
  std::vector<Match> matches(right.begin(), right.end());
  testing::Random random(5);
  for (std::size_t i = 0; i < matches.size(); i += 2)
    matches[i].landmark = static_cast<std::int32_t>(random.below(world_.map().info().num_landmarks));
  const PoseHypothesis hypothesis = estimator_.from_matches(observations_, matches, 1);
  ASSERT_TRUE(hypothesis.is_found);
  EXPECT_LT(pose_error(truth_, hypothesis.T_map_camera).norm(), 0.03);
}

TEST_F(PoseEstimatorTest, WrongMatchesFitNothing) {
  observe(world_.frame(kIndex));
  std::vector<Match> matches;
  testing::Random random(5);
  for (std::int32_t i = 0; i < 200; ++i) {
    matches.push_back(
        {.feature = i, .landmark = static_cast<std::int32_t>(random.below(world_.map().info().num_landmarks)), .distance = 40});
  }
  const PoseHypothesis hypothesis = estimator_.from_matches(observations_, matches, 1);
  EXPECT_TRUE(!hypothesis.is_found || hypothesis.num_inliers < 20) << hypothesis.num_inliers;
  EXPECT_FALSE(estimator_.from_matches(observations_, {}, 1).is_found);
  EXPECT_FALSE(estimator_.from_matches(observations_, std::span(matches).first(3), 1).is_found);
}

TEST_F(PoseEstimatorTest, LookingFromTheWrongPlaceFindsNothing) {
  observe(world_.frame(kIndex));
  PoseHypothesis start;
  start.T_map_camera = sample_pose(300);
  const PoseHypothesis again = estimator_.look_again(observations_, start);
  EXPECT_TRUE(!again.is_found || again.num_inliers < 15) << again.num_inliers;
}

TEST_F(PoseEstimatorTest, SpreadFallsWhereTheImageIsCovered) {
  FrameBuffer frame = world_.frame(kIndex);
  for (int y = 0; y < 240; ++y) std::fill(frame.gray.row(y) + (y < 60 ? 80 : 0), frame.gray.row(y) + 320, std::uint8_t{128});
  observe(frame);
  const PoseHypothesis again = look_from_truth();
  ASSERT_TRUE(again.is_found);
  EXPECT_LE(again.spread, 6.0 / 48) << "a corner of two by two cells and what lies on its rim";
}

/// What lies behind the measured surface is hidden and says nothing; what the camera sees through speaks against the pose.
TEST_F(PoseEstimatorTest, MapDepthTellsHiddenFromSeenThrough) {
  observe(world_.frame(kIndex));
  const PoseHypothesis plain = look_from_truth();
  FrameBuffer near = world_.frame(kIndex), far = near;
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 160; ++x) {
      near.depth.at(x, y) = static_cast<std::uint16_t>(near.depth.at(x, y) / 2);
      far.depth.at(x, y) = static_cast<std::uint16_t>(far.depth.at(x, y) * 3 / 2);
    }
  }
  observe(near);
  const PoseHypothesis hidden = look_from_truth();
  EXPECT_LT(hidden.num_map_depth, plain.num_map_depth * 3 / 4);
  EXPECT_GT(hidden.map_depth_agreement, 0.95);
  observe(far);
  const PoseHypothesis seen_through = look_from_truth();
  EXPECT_GT(seen_through.num_map_depth, plain.num_map_depth * 9 / 10);
  EXPECT_LT(seen_through.map_depth_agreement, 0.75);
}

TEST_F(PoseEstimatorTest, MeasuresTheFocalLength) {
  for (const double factor : {0.93, 1.08}) {
    RgbdCamera camera = world_.camera();
    camera.color.fx *= factor;
    camera.color.fy *= factor;
    camera.depth = camera.color;
    FrameObservations observations(camera, OrbOptions{}, true);
    PoseEstimator estimator(world_.map(), camera, OrbOptions{}, PoseEstimatorOptions{}, &timer_);
    const FrameBuffer frame = world_.frame(kIndex);
    ASSERT_TRUE(observations.observe(frame.view()));
    const auto matches = estimator.match_around(observations, truth_, 40);
    PoseHypothesis hypothesis = estimator.from_matches(observations, matches, 1);
    ASSERT_TRUE(hypothesis.is_found);
    hypothesis = estimator.look_again(observations, hypothesis);
    ASSERT_TRUE(hypothesis.has_focal_scale);
    EXPECT_NEAR(hypothesis.focal_scale, 1 / factor, 0.01);
    EXPECT_LT(hypothesis.focal_scale_sigma, 0.02);
  }
}

}  // namespace
}  // namespace camloc
