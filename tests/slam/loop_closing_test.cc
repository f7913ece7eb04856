// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Loops that must be closed, and look-alikes that must not.
#include "core/slam/loops/loop_closing.h"

#include <gtest/gtest.h>

#include "tests/slam/true_keyframes.h"

namespace camloc {
namespace {

using testing::along_ring;
using testing::looking;
using testing::trajectory_error_m;
using testing::Viewer;
using testing::Walk;
using testing::walk_options;
using testing::walk_through;
using testing::World;

constexpr double kSideM = 7;
constexpr std::uint64_t kDriftBegin = 42, kDriftEnd = 92;

struct RingRun {
  Walk walk;
  SlamResult result;
  SlamCounts counts;
  SlamMap map;
};

/// Once around the ring and a bit more. On the second side the depth camera measures too far, at worst by that factor.
RingRun walk_ring(bool close_loops, double depth_scale, double max_chi2 = SlamNumbers{}.loop_max_chi2) {
  const World world = testing::make_ring(11, kSideM);
  Viewer viewer(world);
  viewer.options().rate_hz = 8;
  SlamOptions options = walk_options();
  options.numbers.close_loops = close_loops ? 1 : 0;
  options.numbers.loop_max_chi2 = max_chi2;
  Slam slam(viewer.camera(), options);
  const auto poses = along_ring(kSideM, 1.5, 4 * kSideM + 4.5, 0.15);
  const Walk walk = walk_through(&viewer, poses, &slam, [&](std::uint64_t frame, FrameFeatures* view) {
    if (frame < kDriftBegin || frame >= kDriftEnd) return;
    const double share = static_cast<double>(frame - kDriftBegin) / (kDriftEnd - kDriftBegin);
    const double scale = 1 + (depth_scale - 1) * std::sin(std::numbers::pi * share);
    for (float& z : view->depth_m) z *= static_cast<float>(scale);
  });
  SlamResult result = slam.finish();
  return {walk, result, slam.counts(), slam.map()};
}

/// By how much the pose of one view relative to another is off, metres.
double relative_error_m(const RingRun& run, std::size_t a, std::size_t b) {
  const Rigid3 T_a_b = run.result.poses[a].T_map_camera.inverse() * run.result.poses[b].T_map_camera;
  const Rigid3 truth = run.walk.T_world_camera[a].inverse() * run.walk.T_world_camera[b];
  return (T_a_b.translation - truth.translation).norm();
}

double largest_step_error_m(const RingRun& run) {
  double largest = 0;
  for (std::size_t i = 1; i < run.result.poses.size(); ++i) largest = std::max(largest, relative_error_m(run, i - 1, i));
  return largest;
}

TEST(LoopClosing, ADriftedLoopIsClosedAndTheErrorSpreadsUnlessItStretchesTheGraph) {
  const RingRun open = walk_ring(false, 1.06), closed = walk_ring(true, 1.06);
  ASSERT_EQ(open.counts.num_lost, 0U);
  ASSERT_EQ(closed.counts.num_lost, 0U);
  EXPECT_EQ(open.counts.num_loops, 0U);
  EXPECT_GE(closed.counts.num_loops, 1U);
  EXPECT_EQ(closed.counts.num_segments, 1U);
  // The same place on the first and the second lap.
  const std::size_t then = 4, now = then + static_cast<std::size_t>(std::lround(4 * kSideM / 0.15));
  EXPECT_GT(relative_error_m(open, then, now), 0.15);
  EXPECT_LT(relative_error_m(closed, then, now), 0.03);
  EXPECT_LT(trajectory_error_m(closed.result, 0, closed.walk.T_world_camera),
            0.8 * trajectory_error_m(open.result, 0, open.walk.T_world_camera));
  // Nowhere is the trajectory torn.
  EXPECT_LT(largest_step_error_m(closed), 0.04);
  // Both laps see the same landmarks.
  std::uint32_t num_common = 0;
  const auto num_keyframes = static_cast<std::uint32_t>(closed.map.keyframes().size());
  for (const CovisibleKeyframe& c : closed.map.covisible(num_keyframes - 1, 1))
    num_common += c.keyframe < num_keyframes / 4 ? c.num_shared : 0;
  EXPECT_GE(num_common, 60U);

  // Where links must not be stretched the same loop is refused, and nothing has moved.
  const RingRun refused = walk_ring(true, 1.06, 1e-6);
  EXPECT_EQ(refused.counts.num_loops, 0U);
  EXPECT_GE(refused.counts.num_loops_refused, 1U);
  ASSERT_EQ(refused.result.poses.size(), open.result.poses.size());
  for (std::size_t i = 0; i < open.result.poses.size(); ++i)
    ASSERT_EQ(refused.result.poses[i].T_map_camera.translation, open.result.poses[i].T_map_camera.translation) << "view " << i;
}

TEST(LoopClosing, ALoopWithoutDriftIsClosedToo) {
  const RingRun run = walk_ring(true, 1.0);
  EXPECT_GE(run.counts.num_loops, 1U);
  EXPECT_EQ(run.counts.num_loops_refused, 0U);
  EXPECT_LT(trajectory_error_m(run.result, 0, run.walk.T_world_camera), 0.04);
}

/// A corridor along x whose both walls repeat every `period_m`.
World repeating_corridor(double length_m, double period_m, int from_period, int to_period) {
  std::mt19937_64 rng(5);
  World piece, world;
  add_wall(rng, {0, 1, 0}, Eigen::Vector3d(0, 0, 2.5), Eigen::Vector3d(period_m, 0, 0), 110, &piece);
  for (auto& point : piece.points) point.normal = -Eigen::Vector3d::UnitY(), point.position_m.y() = 1 - std::abs(point.position_m.y() - 1);
  const std::size_t left = piece.points.size();
  add_wall(rng, {0, -1, 0}, Eigen::Vector3d(period_m, 0, 0), Eigen::Vector3d(0, 0, 2.5), 110, &piece);
  for (std::size_t i = left; i < piece.points.size(); ++i)
    piece.points[i].normal = Eigen::Vector3d::UnitY(), piece.points[i].position_m.y() = -1 + std::abs(piece.points[i].position_m.y() + 1);
  std::mt19937_64 other(6);
  for (int i = 0; i * period_m < length_m; ++i) {
    for (testing::WorldPoint point : piece.points) {
      point.position_m.x() += i * period_m;
      if (i < from_period || i >= to_period) point.descriptor = testing::random_descriptor(other);
      world.points.push_back(point);
    }
  }
  return world;
}

// Every four metres the corridor looks exactly the same.
TEST(LoopClosing, IdenticalStretchesOfACorridorAreNotClosed) {
  const World world = repeating_corridor(24, 4, 1, 5);
  Viewer viewer(world);
  Slam slam(viewer.camera(), walk_options());
  std::vector<Rigid3> poses;
  for (int i = 0; i < 150; ++i) poses.push_back(looking({0.12 * i, 0, 1.4}, 0.6 * std::sin(0.05 * i)));
  const Walk walk = walk_through(&viewer, poses, &slam);
  EXPECT_EQ(slam.counts().num_loops, 0U);
  EXPECT_EQ(slam.counts().num_lost, 0U);
  const SlamResult result = slam.finish();
  EXPECT_LT(trajectory_error_m(result, 0, walk.T_world_camera), 0.05);
}

/// Two rooms far apart. The wall at the end of both is the same poster.
World two_rooms_with_the_same_poster() {
  World world;
  std::mt19937_64 rng(21);
  add_room(rng, {-3, -2.5, 0}, {3, 2.5, 2.8}, 60, &world);
  add_room(rng, {37, -2.5, 0}, {43, 2.5, 2.8}, 60, &world);
  std::mt19937_64 poster(22), again(22);
  add_wall(poster, {2.7, -1, 0.5}, Eigen::Vector3d(0, 0, 2), Eigen::Vector3d(0, 2, 0), 150, &world);
  add_wall(again, {42.7, -1, 0.5}, Eigen::Vector3d(0, 0, 2), Eigen::Vector3d(0, 2, 0), 150, &world);
  return world;
}

TEST(LoopClosing, APosterThatHangsInTwoRoomsDoesNotJoinThem) {
  const World world = two_rooms_with_the_same_poster();
  Viewer viewer(world);
  Slam slam(viewer.camera(), walk_options());
  // Away from the poster; then, within a second, in the other room and nearer to the poster than one can walk in that time.
  std::vector<Rigid3> poses;
  for (int i = 0; i < 60; ++i) poses.push_back(looking({1.0 - 0.05 * i, 0, 1.4}, 0.5 * std::sin(0.1 * i)));
  for (int i = 0; i < 80; ++i) poses.push_back(looking({41.2 + 0.003 * i, 0.4, 1.4}, 1.2 * std::cos(0.06 * i)));
  const Walk walk = walk_through(&viewer, poses, &slam);
  const SlamResult result = slam.finish();
  EXPECT_EQ(slam.counts().num_joined, 0U);
  ASSERT_EQ(result.segments.size(), 2U);
  for (const SlamResult::Segment& segment : result.segments) EXPECT_LT(trajectory_error_m(result, segment.id, walk.T_world_camera), 0.02);
}

// Nothing seen for a while, going on at the other end of the hall, and walking back: one map.
TEST(LoopClosing, SegmentsThatReallyMeetAreJoined) {
  const World world = testing::make_hall();
  Viewer viewer(world);
  Slam slam(viewer.camera(), walk_options());
  std::vector<Rigid3> poses;
  for (int i = 0; i < 40; ++i) poses.push_back(looking({0.1 * i, 0, 1.5}, 0.5 + 0.3 * std::sin(0.1 * i)));
  const std::size_t first_blank = poses.size();
  for (int i = 0; i < 40; ++i) poses.push_back(looking({4 + 0.1 * i, 0, 1.5}, 0.5));
  const std::size_t end_blank = poses.size();
  for (int i = 0; i < 75; ++i) poses.push_back(looking({8 - 0.1 * i, 0.2, 1.5}, 0.5 + 0.3 * std::sin(0.1 * i)));
  const Walk walk = walk_through(&viewer, poses, &slam, [&](std::uint64_t frame, FrameFeatures* view) {
    if (frame >= first_blank && frame < end_blank) *view = viewer.blank(frame);
  });
  const SlamResult result = slam.finish();
  EXPECT_EQ(slam.counts().num_segments, 2U);
  EXPECT_EQ(slam.counts().num_joined, 1U);
  ASSERT_EQ(result.segments.size(), 1U);
  EXPECT_LT(trajectory_error_m(result, result.segments[0].id, walk.T_world_camera), 0.03);
}

// Nothing says how far apart the first and the third segment lie; many views over a few metres do.
TEST(LoopClosing, ASegmentJoinsAnOlderOneWhenManyViewsAgree) {
  World world = testing::make_hall();
  std::mt19937_64 rng(41);
  add_room(rng, {40, -2.5, 0}, {46, 2.5, 2.8}, 90, &world);
  Viewer viewer(world);
  Slam slam(viewer.camera(), walk_options());
  std::vector<Rigid3> poses;
  for (int i = 0; i < 60; ++i) poses.push_back(looking({0.1 * i, 0, 1.5}, 0.5 + 0.3 * std::sin(0.1 * i)));
  for (int i = 0; i < 35; ++i) poses.push_back(looking({42 + 0.02 * i, 0, 1.5}, 0.02 * i));
  for (int i = 0; i < 95; ++i) poses.push_back(looking({9.5 - 0.1 * i, 0.2, 1.5}, 0.5 + 0.3 * std::sin(0.1 * i)));
  const Walk walk = walk_through(&viewer, poses, &slam);
  const SlamResult result = slam.finish();
  EXPECT_EQ(slam.counts().num_segments, 3U);
  EXPECT_EQ(slam.counts().num_joined, 1U);
  ASSERT_EQ(result.segments.size(), 2U);
  EXPECT_GE(result.segments[0].num_views, 140U);
  for (const SlamResult::Segment& segment : result.segments) EXPECT_LT(trajectory_error_m(result, segment.id, walk.T_world_camera), 0.03);
}

}  // namespace
}  // namespace camloc
