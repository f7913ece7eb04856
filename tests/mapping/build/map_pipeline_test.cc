// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Walks without poses become maps; interrupted builds go on to the same bytes; bad walks leave an existing map alone.
#include "tools/mapping/build/map_pipeline.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/geometry/alignment.h"
#include "core/io/sequence.h"
#include "core/map/map_view.h"
#include "tests/base/recording_observer.h"
#include "tests/drivers/test_folder.h"
#include "tests/mapping/recorded_room.h"
#include "tools/mapping/build/frame_log.h"
#include "tools/mapping/build/recording_tracking.h"

namespace camloc::mapping {
namespace {

constexpr std::uint64_t kFrames = 36;

BuildRequest request_for(const std::string& sequence, const std::string& map_path) {
  BuildRequest request;
  request.frames.sequence = sequence;
  request.frames.poses.clear();
  request.camera = room_camera();
  request.slam = room_options();
  request.map_path = map_path;
  request.name = "room";
  return request;
}

Status build(const BuildRequest& request, BuildSummary* summary) { return build_map(request, WorkObserver::nobody(), summary); }

TEST(MapPipeline, AWalkBecomesAMapAndATrajectory) {
  const TestFolder folder;
  record_room(folder / "walk", kFrames);
  BuildRequest request = request_for(folder / "walk", folder / "room.cmap");
  request.trajectory_path = folder / "walk.tum";
  BuildSummary summary;
  const Status built = build(request, &summary);
  ASSERT_TRUE(built.is_ok()) << built.message();
  EXPECT_EQ(summary.num_recorded, kFrames);
  EXPECT_EQ(summary.num_selected, kFrames);
  EXPECT_FALSE(summary.is_partial);
  ASSERT_TRUE(summary.slam.has_value());
  EXPECT_EQ(summary.slam->counts.num_views, kFrames);
  EXPECT_EQ(summary.slam->counts.num_lost, 0U);
  EXPECT_EQ(summary.slam->num_resumed, 0U);
  EXPECT_TRUE(summary.submaps.empty());
  EXPECT_EQ(summary.build.num_frames, kFrames);
  EXPECT_GT(summary.build.num_landmarks, 200U);
  EXPECT_TRUE(std::filesystem::exists(folder / "room.cmap"));
  EXPECT_FALSE(std::filesystem::exists(frame_log_path(folder / "room.cmap")));

  const auto trajectory = read_tum_trajectory(folder / "walk.tum");
  ASSERT_TRUE(trajectory.is_ok()) << trajectory.status().message();
  ASSERT_EQ(trajectory->size(), kFrames);
  std::vector<PointPair> pairs;
  for (std::uint64_t i = 0; i < kFrames; ++i)
    pairs.push_back({.p_a = room_pose(i).translation, .p_b = trajectory.value()[i].T_world_camera.translation});
  EXPECT_LT(align_rigid(pairs).rms_m, 0.01);

  // Poses found in the map say how much it is bent.
  const auto map = MapView::open(folder / "room.cmap");
  ASSERT_TRUE(map.is_ok());
  EXPECT_GT(summary.deformation.sigma_m, 0.0001);
  EXPECT_LT(summary.deformation.sigma_m, 0.01);
  EXPECT_NEAR(map->info().pose_sigma_m, std::hypot(summary.deformation.sigma_m, summary.consistency_sigma_m), 1e-12);
  EXPECT_NEAR(map->info().pose_sigma_rad, std::hypot(summary.deformation.sigma_rad, summary.consistency_sigma_rad), 1e-12);
  EXPECT_NE(format_table(summary).find("deformation of the map"), std::string::npos);
}

/// The log of a whole build, as a build that died just before its end would have left it.
std::vector<std::uint8_t> whole_log(const TestFolder& folder, const BuildRequest& request) {
  const auto frames = find_frames(request.frames);
  EXPECT_TRUE(frames.is_ok());
  TrackingRequest walk;
  walk.url = frames->url;
  walk.num_frames = frames->num_selected;
  walk.camera = request.camera;
  walk.orb = request.map.orb;
  walk.slam = request.slam;
  walk.log_path = folder / "whole.views";
  Slam slam(walk.camera, walk.slam);
  RecordingCheck check(walk.camera);
  const auto end = track_recording(walk, &slam, &check, WorkObserver::nobody());
  EXPECT_TRUE(end.is_ok()) << end.status().message();
  return bytes_of(walk.log_path);
}

TEST(MapPipeline, AnInterruptedBuildGoesOnToTheSameBytes) {
  const TestFolder folder;
  record_room(folder / "walk", kFrames);
  const BuildRequest request = request_for(folder / "walk", folder / "whole.cmap");
  BuildSummary summary;
  ASSERT_TRUE(build(request, &summary).is_ok());
  const auto expected = bytes_of(folder / "whole.cmap");
  ASSERT_FALSE(expected.empty());

  BuildRequest resumed = request_for(folder / "walk", folder / "resumed.cmap");
  resumed.is_resumed = true;
  const std::vector<std::uint8_t> log = whole_log(folder, resumed);
  // Killed at once, in the middle of a record, after the last one.
  for (const double share : {0.0, 0.4, 1.0}) {
    const std::size_t size = 64 + static_cast<std::size_t>(share * static_cast<double>(log.size() - 64));
    folder.write("resumed.cmap.views", {log.begin(), log.begin() + static_cast<std::ptrdiff_t>(size)});
    BuildSummary of_resumed;
    const Status built = build(resumed, &of_resumed);
    ASSERT_TRUE(built.is_ok()) << built.message();
    EXPECT_EQ(of_resumed.slam->counts.num_views, kFrames);
    EXPECT_NEAR(static_cast<double>(of_resumed.slam->num_resumed), share * static_cast<double>(kFrames), 3);
    EXPECT_EQ(bytes_of(folder / "resumed.cmap"), expected) << share;
    EXPECT_FALSE(std::filesystem::exists(folder / "resumed.cmap.views"));
  }
}

TEST(MapPipeline, AStoppedBuildIsAMapOfTheFirstPartAndGoesOnFromThere) {
  const TestFolder folder;
  record_room(folder / "walk", kFrames);
  BuildRequest request = request_for(folder / "walk", folder / "whole.cmap");
  BuildSummary summary;
  testing::RecordingObserver all, half(kFrames / 2);
  ASSERT_TRUE(build_map(request, all, &summary).is_ok());
  EXPECT_EQ(all.count("frame"), kFrames);
  EXPECT_EQ(all.count("mapping view"), kFrames);
  EXPECT_EQ(all.count("comparing maps of half of the observations each ..."), 1U);
  EXPECT_TRUE(all.is_monotone());

  request.map_path = folder / "half.cmap";
  BuildSummary of_half;
  const Status built = build_map(request, half, &of_half);
  ASSERT_TRUE(built.is_ok()) << built.message();
  EXPECT_TRUE(of_half.is_partial);
  EXPECT_EQ(of_half.build.num_frames, kFrames / 2);
  EXPECT_TRUE(MapView::open(request.map_path).is_ok());
  request.is_resumed = true;
  ASSERT_TRUE(build(request, &of_half).is_ok());
  EXPECT_EQ(bytes_of(request.map_path), bytes_of(folder / "whole.cmap"));
}

TEST(MapPipeline, AStoppedBuildFromPosesLeavesTheOldMap) {
  const TestFolder folder;
  record_room(folder / "walk", 8);
  std::vector<StampedPose> poses;
  std::string text;
  for (std::uint64_t i = 0; i < 8; ++i)
    text += format_tum_line(100'000'000'000 + static_cast<std::int64_t>(i * 66'666'667), room_pose(i)) + "\n";
  BuildRequest request = request_for(folder / "walk", folder.write("room.cmap", "old"));
  request.frames.poses = folder.write("poses.tum", text);
  BuildSummary summary;
  testing::RecordingObserver all, three(3);
  const Status stopped = build_map(request, three, &summary);
  EXPECT_EQ(stopped.code(), ErrorCode::kIo);
  EXPECT_NE(stopped.message().find("interrupted"), std::string::npos) << stopped.message();
  EXPECT_EQ(bytes_of(request.map_path).size(), 3U);
  EXPECT_EQ(three.steps.size(), 3U);
  ASSERT_TRUE(build_map(request, all, &summary).is_ok());
  EXPECT_EQ(all.count("frame"), 8U);
  EXPECT_TRUE(all.is_monotone());
  EXPECT_TRUE(MapView::open(request.map_path).is_ok());
}

TEST(MapPipeline, TheLogOfAnotherBuildIsRefusedAndKept) {
  const TestFolder folder;
  record_room(folder / "walk", 8);
  record_room(folder / "other", 8);
  BuildRequest request = request_for(folder / "walk", folder / "room.cmap");
  const std::vector<std::uint8_t> log = whole_log(folder, request_for(folder / "other", folder / "x.cmap"));
  folder.write("room.cmap.views", {log.begin(), log.end()});
  folder.write("room.cmap", "old");
  request.is_resumed = true;
  BuildSummary summary;
  const Status status = build(request, &summary);
  EXPECT_EQ(status.code(), ErrorCode::kInvalid);
  EXPECT_NE(status.message().find("another recording"), std::string::npos) << status.message();
  EXPECT_EQ(bytes_of(folder / "room.cmap.views"), log);
  EXPECT_EQ(bytes_of(folder / "room.cmap").size(), 3U);
}

TEST(MapPipeline, WalksThatAreNoneLeaveTheOldMapAndNoLog) {
  const TestFolder folder;
  record_room(folder / "constant", 34, [](std::uint64_t, FrameBuffer* frame) {
    std::fill(frame->depth.pixels.begin(), frame->depth.pixels.end(), std::uint16_t{2000});
  });
  record_room(folder / "still", 12, [](std::uint64_t, FrameBuffer* frame) { SampleRoom().render(room_camera(), room_pose(0), frame); });
  record_room(folder / "bare", 12, [](std::uint64_t, FrameBuffer* frame) {
    std::fill(frame->gray.pixels.begin(), frame->gray.pixels.end(), std::uint8_t{100});
  });
  const std::string old = folder.write("room.cmap", "old");
  for (const auto& [name, text] : {std::pair{"constant", "depth is the same everywhere"}, {"still", "stood still"}, {"bare", "texture"}}) {
    BuildSummary summary;
    const Status status = build(request_for(folder / name, old), &summary);
    EXPECT_EQ(status.code(), ErrorCode::kInvalid) << name;
    EXPECT_NE(status.message().find(text), std::string::npos) << status.message();
    EXPECT_EQ(bytes_of(old).size(), 3U);
    EXPECT_FALSE(std::filesystem::exists(frame_log_path(old))) << name;
  }
}

TEST(MapPipeline, BrokenImagesAreLeftOutAndNamed) {
  const TestFolder folder;
  record_room(folder / "walk", kFrames);
  folder.write("walk/rgb/1010.png", "broken");
  folder.write("walk/depth/1020.png", "");
  BuildSummary summary;
  const Status built = build(request_for(folder / "walk", folder / "room.cmap"), &summary);
  ASSERT_TRUE(built.is_ok()) << built.message();
  EXPECT_EQ(summary.reading.num_corrupt, 2U);
  EXPECT_NE(summary.reading.first_corrupt.find("rgb/1010.png"), std::string::npos) << summary.reading.first_corrupt;
  EXPECT_EQ(summary.build.num_frames, kFrames - 2);
}

// The recording goes on in a part of the room that nobody has seen on the way: two maps.
TEST(MapPipeline, SegmentsThatDoNotMeetAreMapsOfTheirOwn) {
  const TestFolder folder;
  record_room(folder / "walk", 70, [](std::uint64_t frame, FrameBuffer* buffer) {
    if (frame >= 25) SampleRoom().render(room_camera(), sample_pose(300 + 2 * frame), buffer);
  });
  BuildRequest request = request_for(folder / "walk", folder / "room.cmap");
  BuildSummary summary;
  const Status built = build(request, &summary);
  ASSERT_TRUE(built.is_ok()) << built.message();
  ASSERT_EQ(summary.submaps.size(), 1U);
  EXPECT_EQ(summary.submaps[0].map_path, folder / "room.2.cmap");
  EXPECT_TRUE(std::filesystem::exists(folder / "room.2.cmap"));
  EXPECT_EQ(summary.slam->counts.num_segments, 2U);
  EXPECT_EQ(summary.build.num_frames + summary.submaps[0].num_views + summary.slam->counts.num_lost, 70U);
}

TEST(MapPipeline, WithoutDepthThereIsNoMap) {
  const TestFolder folder;
  record_room(folder / "walk", 3);
  std::filesystem::remove(folder / "walk/depth.txt");
  std::filesystem::remove_all(folder / "walk/depth");
  BuildSummary summary;
  const Status status = build(request_for(folder / "walk", folder / "room.cmap"), &summary);
  EXPECT_EQ(status.code(), ErrorCode::kInvalid);
  EXPECT_NE(status.message().find("no depth images"), std::string::npos) << status.message();
}

}  // namespace
}  // namespace camloc::mapping
