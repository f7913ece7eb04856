// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Three seconds of a walk show a wall without features: thumbnails carry SLAM across.
#include <gtest/gtest.h>

#include "core/slam/slam.h"
#include "tests/dense/generated_thumbnail.h"
#include "tests/slam/generated_walk.h"

namespace camloc {
namespace {

using testing::circle;
using testing::trajectory_error_m;

constexpr std::uint64_t kBareBegin = 30, kBareEnd = 60;

/// A turn in a room; between kBareBegin and kBareEnd no features are seen.
struct TurnInARoom {
  testing::World world = testing::make_room();
  testing::Viewer viewer{world};
  testing::BoxRenderer renderer{viewer.camera(), {-3, -2.5, 0}, {3, 2.5, 2.8}};
  std::vector<Rigid3> T_world_camera = circle(90, 0.8, 0, 3.6);
  std::vector<FrameReport> reports;
  Slam slam{viewer.camera(), testing::walk_options()};

  template <class Bare>
  SlamResult walk(bool has_thumbnails, const Bare& bare_view) {
    for (std::uint64_t frame = 0; frame < T_world_camera.size(); ++frame) {
      FrameFeatures view = viewer.see(frame, T_world_camera[frame]);
      if (frame >= kBareBegin && frame < kBareEnd) view = bare_view(frame);
      reports.push_back(slam.add_view(frame, view, has_thumbnails ? renderer.see(T_world_camera[frame]) : Thumbnail()));
    }
    return slam.finish();
  }
};

TEST(SlamBridge, CarriesAcrossABareWall) {
  TurnInARoom turn;
  const SlamResult result = turn.walk(true, [&](std::uint64_t frame) { return turn.viewer.blank(frame); });
  EXPECT_EQ(turn.slam.counts().num_lost, 0U);
  EXPECT_EQ(turn.slam.counts().num_segments, 1U);
  EXPECT_GE(turn.slam.counts().num_bridged, kBareEnd - kBareBegin);
  EXPECT_EQ(result.poses.size(), 90U);
  EXPECT_LT(trajectory_error_m(result, 0, turn.T_world_camera), 0.03);
  std::uint32_t num_bridged = 0, num_keyframes = 0;
  for (const FrameReport& report : turn.reports) {
    num_bridged += report.is_bridged ? 1U : 0U;
    num_keyframes += report.is_bridged && report.is_keyframe ? 1U : 0U;
  }
  EXPECT_EQ(num_bridged, turn.slam.counts().num_bridged);
  EXPECT_GE(num_keyframes, 10U);  // 1.2 rad are turned
  const Rigid3 T_before_after = result.poses[kBareBegin - 1].T_map_camera.inverse() * result.poses[kBareEnd].T_map_camera;
  const Rigid3 expected = turn.T_world_camera[kBareBegin - 1].inverse() * turn.T_world_camera[kBareEnd];
  EXPECT_LT((T_before_after.translation - expected.translation).norm(), 0.015);
  EXPECT_LT(rotation_distance_rad(T_before_after.rotation, expected.rotation), 0.004);
}

TEST(SlamBridge, WithoutThumbnailsASegmentEnds) {
  TurnInARoom turn;
  (void)turn.walk(false, [&](std::uint64_t frame) { return turn.viewer.blank(frame); });
  EXPECT_GT(turn.slam.counts().num_lost, 0U);
  EXPECT_EQ(turn.slam.counts().num_segments, 2U);
  EXPECT_EQ(turn.slam.counts().num_bridged, 0U);
}

// Features that fit nothing are no bare wall: somebody may stand in front of the camera.
TEST(SlamBridge, DoesNotFollowWhatIsFullOfFeatures) {
  TurnInARoom turn;
  const testing::World elsewhere = testing::make_room(77);
  testing::Viewer other(elsewhere);
  (void)turn.walk(true, [&](std::uint64_t frame) {
    std::mt19937_64 rng(frame);
    FrameFeatures view = other.see(frame, turn.T_world_camera[frame]);
    for (Descriptor& descriptor : view.features.descriptors) descriptor = testing::random_descriptor(rng);
    return view;
  });
  EXPECT_EQ(turn.slam.counts().num_bridged, 0U);
  EXPECT_GT(turn.slam.counts().num_lost, 0U);
}

}  // namespace
}  // namespace camloc
