// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Which frames of a recording go into a map, and where the colour camera was then.
#include "tools/mapping/build/posed_frames.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "core/io/sequence.h"
#include "tests/drivers/test_folder.h"
#include "tests/mapping/recorded_room.h"

namespace camloc::mapping {
namespace {

TEST(FindFrames, CountsAndSelects) {
  const TestFolder folder;
  record_room(folder / "walk", 10);
  PosedFramesRequest request;
  request.sequence = "replay://" + (folder / "walk");
  auto frames = find_frames(request);
  ASSERT_TRUE(frames.is_ok()) << frames.status().message();
  EXPECT_EQ(frames->num_recorded, 10U);
  EXPECT_EQ(frames->num_selected, 10U);
  EXPECT_TRUE(frames->has_depth);
  EXPECT_EQ(frames->url, "replay://" + (folder / "walk") + "?frames=0:10:1");
  request.include = "2:9:3";
  request.exclude = "5";
  frames = find_frames(request);
  ASSERT_TRUE(frames.is_ok()) << frames.status().message();
  EXPECT_EQ(frames->num_selected, 2U);
  for (const char* sequence : {"telepathy://x", "replay:///nowhere?loop=1", "/nowhere"}) {
    request.sequence = sequence;
    const auto refused = find_frames(request);
    ASSERT_FALSE(refused.is_ok()) << sequence;
    EXPECT_NE(refused.status().message().find(std::string(sequence).substr(0, 8)), std::string::npos) << refused.status().message();
  }
}

TEST(FindFrames, SaysWhetherThereIsDepth) {
  const TestFolder folder;
  record_room(folder / "walk", 3);
  std::filesystem::remove(folder / "walk/depth.txt");
  std::filesystem::remove_all(folder / "walk/depth");
  PosedFramesRequest request;
  request.sequence = folder / "walk";
  const auto frames = find_frames(request);
  ASSERT_TRUE(frames.is_ok()) << frames.status().message();
  EXPECT_FALSE(frames->has_depth);
}

/// Poses of all frames but the fourth.
std::string trajectory(const TestFolder& folder, std::uint64_t count) {
  std::string text;
  for (std::uint64_t i = 0; i < count; ++i)
    if (i != 3)
      text += format_tum_line(100'000'000'000 + static_cast<std::int64_t>(1e9 * static_cast<double>(i) / 15), room_pose(i)) + "\n";
  return folder.write("poses.tum", text);
}

TEST(FindPosedFrames, TakesPosesOfATrajectoryByTime) {
  const TestFolder folder;
  record_room(folder / "walk", 8);
  PosedFramesRequest request;
  request.sequence = folder / "walk";
  request.poses = trajectory(folder, 8);
  request.include = "1:7";
  const auto frames = find_posed_frames(request, room_camera());
  ASSERT_TRUE(frames.is_ok()) << frames.status().message();
  EXPECT_EQ(frames->num_recorded, 8U);
  EXPECT_EQ(frames->num_selected, 6U);
  for (const auto& [frame, T_map_camera] : frames->T_map_camera_of_frame) {
    EXPECT_TRUE(frame >= 1 && frame < 7);
    if (frame == 3) continue;
    EXPECT_LT((T_map_camera.translation - room_pose(frame).translation).norm(), 1e-6) << frame;
  }
  EXPECT_EQ(frames->T_map_camera_of_frame.size() + frames->num_without_pose, 6U);
  EXPECT_FALSE(frames->scale);
}

TEST(FindPosedFrames, PosesOfTheDepthCameraBecomeThoseOfTheColourCamera) {
  const TestFolder folder;
  record_room(folder / "walk", 3);
  RgbdCamera camera = room_camera();
  camera.T_color_depth.translation = {0.025, 0, 0};
  PosedFramesRequest request;
  request.sequence = folder / "walk";
  request.poses = trajectory(folder, 3);
  request.pose_camera = PoseCamera::kDepth;
  const auto frames = find_posed_frames(request, camera);
  ASSERT_TRUE(frames.is_ok()) << frames.status().message();
  const Rigid3 expected = room_pose(1) * camera.T_color_depth.inverse();
  EXPECT_LT((frames->T_map_camera_of_frame.at(1).translation - expected.translation).norm(), 1e-6);
}

TEST(FindPosedFrames, RefusesPosesOfAnotherTime) {
  const TestFolder folder;
  record_room(folder / "walk", 3);
  PosedFramesRequest request;
  request.sequence = folder / "walk";
  request.poses = folder.write("late.tum", "900 0 0 0 0 0 0 1\n901 0 0 0 0 0 0 1\n");
  const auto frames = find_posed_frames(request, room_camera());
  ASSERT_FALSE(frames.is_ok());
  EXPECT_NE(frames.status().message().find("none of the 3 selected frames"), std::string::npos) << frames.status().message();
  request.poses = "colmap:/nowhere";
  request.pose_camera = PoseCamera::kDepth;
  EXPECT_NE(find_posed_frames(request, room_camera()).status().message().find("--poses-of depth"), std::string::npos);
}

}  // namespace
}  // namespace camloc::mapping
