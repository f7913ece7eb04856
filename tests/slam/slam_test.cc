// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Walks through generated rooms and corridors: what SLAM says about them against what is true.
#include "core/slam/slam.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/slam/true_keyframes.h"

namespace camloc {
namespace {

using testing::circle;
using testing::looking;
using testing::trajectory_error_m;
using testing::Viewer;
using testing::ViewerOptions;
using testing::Walk;
using testing::walk_options;
using testing::walk_through;
using testing::World;

constexpr double kPi = std::numbers::pi;

std::vector<Rigid3> joined(std::vector<Rigid3> a, const std::vector<Rigid3>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

TEST(Slam, TracksALoopAroundARoom) {
  const World world = testing::make_room();
  Viewer viewer(world);
  Slam slam(viewer.camera(), walk_options());
  const Walk walk = walk_through(&viewer, circle(140, 0.8, 0, 2 * kPi + 0.5), &slam);
  const SlamResult result = slam.finish();
  const SlamCounts counts = slam.counts();
  EXPECT_EQ(counts.num_views, 140U);
  EXPECT_EQ(counts.num_lost, 0U);
  EXPECT_EQ(counts.num_losses, 0U);
  EXPECT_EQ(counts.num_segments, 1U);
  EXPECT_EQ(counts.num_joined, 0U);
  ASSERT_EQ(result.segments.size(), 1U);
  EXPECT_EQ(result.segments[0].num_views, 140U);
  EXPECT_EQ(result.segments[0].num_keyframes, counts.num_keyframes);
  ASSERT_EQ(result.poses.size(), 140U);
  EXPECT_LT(trajectory_error_m(result, 0, walk.T_world_camera), 0.01);
  EXPECT_LT(result.segments[0].fit.median_px, 0.7);
  EXPECT_GT(result.segments[0].fit.num_observations, 3000U);

  // Reports, counts and poses tell the same story.
  std::uint32_t num_keyframes = 0, num_loops = 0;
  for (std::size_t i = 0; i < result.poses.size(); ++i) {
    EXPECT_EQ(result.poses[i].frame, i);
    EXPECT_EQ(result.poses[i].is_keyframe, walk.reports[i].is_keyframe);
    EXPECT_EQ(walk.reports[i].state, ViewState::kTracked);
    EXPECT_EQ(walk.reports[i].has_begun_segment, i == 0);
    EXPECT_TRUE(i == 0 || walk.reports[i].num_inliers >= 30);
    num_keyframes += walk.reports[i].is_keyframe ? 1U : 0U;
    num_loops += walk.reports[i].loop.is_closed ? 1U : 0U;
  }
  EXPECT_EQ(num_keyframes, counts.num_keyframes);
  EXPECT_EQ(num_loops, counts.num_loops);
  EXPECT_EQ(slam.map().keyframes().size(), num_keyframes);
  EXPECT_LT(num_keyframes, 100U);
}

TEST(Slam, TellsHowMuchItsMapIsBent) {
  const World world = testing::make_room();
  Viewer viewer(world);
  Slam slam(viewer.camera(), walk_options());
  const Walk walk = walk_through(&viewer, circle(140, 0.8, 0, 2 * kPi + 0.5), &slam);
  const SlamResult result = slam.finish();
  ASSERT_EQ(result.segments.size(), 1U);
  const double error_m = trajectory_error_m(result, result.segments.front().id, walk.T_world_camera) / std::sqrt(3.0);
  const MapUncertainty deformation = slam.uncertainty(result.segments.front().id);
  EXPECT_GT(deformation.sigma_m, error_m / 3);
  EXPECT_LT(deformation.sigma_m, error_m * 3);
  EXPECT_GT(deformation.sigma_rad, 0);
  EXPECT_LT(deformation.sigma_rad, 0.01);
  EXPECT_EQ(slam.uncertainty(77).sigma_m, 0);
}

TEST(Slam, TheSameViewsGiveTheSameBits) {
  const auto run = [] {
    const World world = testing::make_room();
    Viewer viewer(world);
    Slam slam(viewer.camera(), walk_options());
    walk_through(&viewer, circle(40, 0.8, 0, 2), &slam);
    return slam.finish();
  };
  const SlamResult a = run(), b = run();
  ASSERT_EQ(a.poses.size(), b.poses.size());
  for (std::size_t i = 0; i < a.poses.size(); ++i) {
    EXPECT_EQ(a.poses[i].T_map_camera.translation, b.poses[i].T_map_camera.translation);
    EXPECT_EQ(a.poses[i].T_map_camera.rotation.coeffs(), b.poses[i].T_map_camera.rotation.coeffs());
    EXPECT_EQ(a.poses[i].num_inliers, b.poses[i].num_inliers);
  }
  EXPECT_EQ(a.segments[0].fit.median_px, b.segments[0].fit.median_px);
}

TEST(Slam, ViewsBetweenKeyframesAreAsGoodAsKeyframes) {
  const World world = testing::make_room();
  Viewer viewer(world);
  Slam slam(viewer.camera(), walk_options());
  const Walk walk = walk_through(&viewer, circle(80, 0.8, 0, 3), &slam);
  SlamResult result = slam.finish();
  const auto error_of = [&](bool is_keyframe) {
    SlamResult some = result;
    std::erase_if(some.poses, [&](const SlamPose& pose) { return pose.is_keyframe != is_keyframe; });
    EXPECT_GE(some.poses.size(), 15U);
    return trajectory_error_m(some, 0, walk.T_world_camera);
  };
  EXPECT_LT(error_of(false), 1.3 * error_of(true) + 0.001);
}

TEST(Slam, SurvivesWrongDescriptorsAndWrongDepths) {
  const World world = testing::make_room();
  ViewerOptions options;
  options.descriptor_outlier_share = 0.25;
  options.depth_outlier_share = 0.15;
  Viewer viewer(world, options);
  Slam slam(viewer.camera(), walk_options());
  const Walk walk = walk_through(&viewer, circle(80, 0.8, 0, 3), &slam);
  const SlamResult result = slam.finish();
  EXPECT_EQ(slam.counts().num_lost, 0U);
  EXPECT_LT(trajectory_error_m(result, 0, walk.T_world_camera), 0.02);
}

TEST(Slam, DepthReducesTheError) {
  const World world = testing::make_room();
  const auto error_with = [&](bool in_tracking, bool in_adjustment) {
    ViewerOptions options;
    options.noise_px = 1.0;
    Viewer viewer(world, options);
    SlamOptions slam_options = walk_options();
    slam_options.numbers.depth_in_tracking = in_tracking ? 1 : 0;
    slam_options.numbers.depth_in_adjustment = in_adjustment ? 1 : 0;
    Slam slam(viewer.camera(), slam_options);
    const Walk walk = walk_through(&viewer, circle(80, 0.8, 0, 3.5), &slam);
    const SlamResult result = slam.finish();
    EXPECT_EQ(slam.counts().num_segments, 1U);
    return trajectory_error_m(result, 0, walk.T_world_camera);
  };
  const double both = error_with(true, true), none = error_with(false, false);
  EXPECT_LT(both, none);
  EXPECT_LT(error_with(false, true), none);
  EXPECT_LT(both, 0.01);
}

TEST(Slam, BlankViewsAreLostAndThenTrackingIsFoundBack) {
  const World world = testing::make_room();
  Viewer viewer(world);
  Slam slam(viewer.camera(), walk_options());
  const Walk walk = walk_through(&viewer, circle(60, 0.8, 0, 1.5), &slam, [&](std::uint64_t frame, FrameFeatures* view) {
    if (frame >= 25 && frame < 30) *view = viewer.blank(frame);
  });
  const SlamResult result = slam.finish();
  EXPECT_EQ(slam.counts().num_lost, 5U);
  EXPECT_EQ(slam.counts().num_losses, 1U);
  EXPECT_EQ(slam.counts().num_segments, 1U);
  for (std::size_t i = 25; i < 30; ++i) EXPECT_EQ(walk.reports[i].state, ViewState::kLost);
  for (std::size_t i = 30; i < 60; ++i) EXPECT_EQ(walk.reports[i].state, ViewState::kTracked);
  EXPECT_EQ(result.poses.size(), 55U);
  EXPECT_LT(trajectory_error_m(result, 0, walk.T_world_camera), 0.015);
}

// Carried back to a place of before while nothing was seen.
TEST(Slam, IsFoundBackAtAPlaceOfBefore) {
  const World world = testing::make_room();
  Viewer viewer(world);
  Slam slam(viewer.camera(), walk_options());
  const auto poses = joined(circle(80, 0.8, 0, 2.5), circle(20, 0.8, 0.3, 0.9));
  const Walk walk = walk_through(&viewer, poses, &slam, [&](std::uint64_t frame, FrameFeatures* view) {
    if (frame >= 76 && frame < 81) *view = viewer.blank(frame);
  });
  EXPECT_EQ(walk.reports[81].state, ViewState::kTracked);
  EXPECT_EQ(slam.counts().num_segments, 1U);
  EXPECT_LT(trajectory_error_m(slam.finish(), 0, walk.T_world_camera), 0.015);
}

TEST(Slam, AJumpToAnUnseenPlaceBeginsASegmentOfItsOwn) {
  World world = testing::make_room();
  std::mt19937_64 rng(77);
  add_room(rng, {20, -2.5, 0}, {26, 2.5, 2.8}, 60, &world);
  Viewer viewer(world);
  Slam slam(viewer.camera(), walk_options());
  std::vector<Rigid3> there = circle(50, 0.8, -0.5, 1);
  for (Rigid3& T : there) T.translation.x() += 23;
  const Walk walk = walk_through(&viewer, joined(circle(40, 0.8, 0, 1.5), there), &slam);
  const SlamResult result = slam.finish();
  const SlamCounts counts = slam.counts();
  EXPECT_EQ(counts.num_segments, 2U);
  EXPECT_EQ(counts.num_joined, 0U);
  EXPECT_EQ(counts.num_losses, 1U);
  EXPECT_EQ(counts.num_lost, 10U);
  EXPECT_TRUE(walk.reports[50].has_begun_segment);
  ASSERT_EQ(result.segments.size(), 2U);
  EXPECT_EQ(result.segments[0].num_views, 40U);
  EXPECT_EQ(result.segments[1].num_views, 40U);
  EXPECT_NE(result.segments[0].id, result.segments[1].id);
  EXPECT_EQ(result.segments[0].num_keyframes + result.segments[1].num_keyframes, counts.num_keyframes);
  for (const SlamResult::Segment& segment : result.segments) EXPECT_LT(trajectory_error_m(result, segment.id, walk.T_world_camera), 0.01);
}

TEST(Slam, ASegmentBegunInTheSameRoomIsJoined) {
  const World world = testing::make_room();
  Viewer viewer(world);
  Slam slam(viewer.camera(), walk_options());
  // Looks at one side, is covered while it turns around, and comes back to the first side.
  const auto poses = joined(circle(40, 0.8, 0, 1.2), circle(90, 0.8, 3.6, 2 * kPi + 1.0));
  const Walk walk = walk_through(&viewer, poses, &slam, [&](std::uint64_t frame, FrameFeatures* view) {
    if (frame >= 38 && frame < 42) *view = viewer.blank(frame);
  });
  const SlamResult result = slam.finish();
  EXPECT_EQ(slam.counts().num_segments, 2U);
  EXPECT_EQ(slam.counts().num_joined, 1U);
  ASSERT_EQ(result.segments.size(), 1U);
  EXPECT_EQ(result.segments[0].num_views, result.poses.size());
  EXPECT_LT(trajectory_error_m(result, result.segments[0].id, walk.T_world_camera), 0.02);
}

TEST(Slam, WithoutLoopsNothingIsJoined) {
  const World world = testing::make_room();
  Viewer viewer(world);
  SlamOptions options = walk_options();
  options.numbers.close_loops = 0;
  Slam slam(viewer.camera(), options);
  const auto poses = joined(circle(40, 0.8, 0, 1.2), circle(90, 0.8, 3.6, 2 * kPi + 1.0));
  walk_through(&viewer, poses, &slam, [&](std::uint64_t frame, FrameFeatures* view) {
    if (frame >= 38 && frame < 42) *view = viewer.blank(frame);
  });
  EXPECT_EQ(slam.finish().segments.size(), 2U);
  EXPECT_EQ(slam.counts().num_joined, 0U);
}

TEST(Slam, TooLittleDepthBeginsNoSegment) {
  const World world = testing::make_room();
  ViewerOptions options;
  options.hole_share = 0.9;
  Viewer viewer(world, options);
  Slam slam(viewer.camera(), walk_options());
  walk_through(&viewer, circle(15, 0.8, 0, 0.3), &slam);
  EXPECT_EQ(slam.counts().num_lost, 15U);
  EXPECT_EQ(slam.counts().num_segments, 0U);
  const SlamResult result = slam.finish();
  EXPECT_TRUE(result.segments.empty());
  EXPECT_TRUE(result.poses.empty());
}

TEST(Slam, FinishWithoutViewsIsEmpty) {
  Slam slam(Viewer(World{}).camera(), walk_options());
  EXPECT_TRUE(slam.finish().poses.empty());
}

TEST(Slam, TheFinalAdjustmentCanBeStopped) {
  const World world = testing::make_room();
  Viewer viewer(world);
  Slam slam(viewer.camera(), walk_options());
  walk_through(&viewer, circle(20, 0.8, 0, 0.8), &slam);
  int num_calls = 0;
  const SlamResult result = slam.finish([&](int, double) { return ++num_calls < 1; });
  EXPECT_EQ(num_calls, 1);
  EXPECT_EQ(result.poses.size(), 20U);
}

// A hall whose end the depth camera does not reach, with a stretch where it measures nothing at all.
TEST(Slam, FarLandmarksCarryTrackingWithoutDepth) {
  const World world = testing::make_hall();
  std::vector<Rigid3> poses;
  for (int i = 0; i < 110; ++i) poses.push_back(looking({0.08 * i, 0.1 * std::sin(0.1 * i), 1.5}, 0.05 * std::sin(0.07 * i)));
  const auto run = [&](bool has_far, std::uint32_t* num_lost, double* error_m) {
    Viewer viewer(world);
    SlamOptions options = walk_options();
    if (!has_far) options.numbers.far_max_distance_m = 0;
    Slam slam(viewer.camera(), options);
    const Walk walk = walk_through(&viewer, poses, &slam, [&](std::uint64_t frame, FrameFeatures* view) {
      if (frame >= 50 && frame < 85) std::fill(view->depth_m.begin(), view->depth_m.end(), 0.0F);
    });
    std::uint32_t num_far = 0;
    for (const SlamLandmark& landmark : slam.map().landmarks()) {
      if (!landmark.is_alive()) continue;
      num_far += std::none_of(landmark.observations.begin(), landmark.observations.end(),
                              [&](const Observation& s) { return slam.map().keyframe(s.keyframe).view.depth_m[s.feature] > 0; })
                     ? 1U
                     : 0U;
    }
    EXPECT_EQ(num_far > 100, has_far) << num_far;
    const SlamResult result = slam.finish();
    ASSERT_FALSE(result.segments.empty());
    *num_lost = slam.counts().num_lost;
    *error_m = trajectory_error_m(result, result.segments.front().id, walk.T_world_camera);
  };
  std::uint32_t num_lost = 0, num_lost_without = 0;
  double error_m = 0, error_without_m = 0;
  run(true, &num_lost, &error_m);
  run(false, &num_lost_without, &error_without_m);
  EXPECT_EQ(num_lost, 0U);
  EXPECT_LT(error_m, 0.04);
  EXPECT_GT(num_lost_without, 5U);
}

}  // namespace
}  // namespace camloc
