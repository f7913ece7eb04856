// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The first pass over a recording: its log, what it counts, and being interrupted.
#include "tools/mapping/build/recording_tracking.h"

#include <gtest/gtest.h>

#include "tests/base/recording_observer.h"
#include "tests/drivers/test_folder.h"
#include "tests/mapping/recorded_room.h"
#include "tools/mapping/build/frame_log.h"

namespace camloc::mapping {
namespace {

TrackingRequest request_for(const TestFolder& folder) {
  TrackingRequest request;
  request.url = "replay://" + (folder / "walk");
  request.camera = room_camera();
  request.slam = room_options();
  request.log_path = folder / "log";
  return request;
}

Result<RecordingEnd> track(const TrackingRequest& request, SlamCounts* counts = nullptr, WorkObserver& observer = WorkObserver::nobody()) {
  Slam slam(request.camera, request.slam);
  RecordingCheck check(request.camera);
  auto end = track_recording(request, &slam, &check, observer);
  if (counts != nullptr) *counts = slam.counts();
  return end;
}

TEST(RecordingTracking, EveryViewIsTrackedAndLogged) {
  const TestFolder folder;
  record_room(folder / "walk", 12);
  const TrackingRequest request = request_for(folder);
  SlamCounts counts;
  testing::RecordingObserver observer;
  const auto end = track(request, &counts, observer);
  ASSERT_TRUE(end.is_ok()) << end.status().message();
  EXPECT_FALSE(end->is_interrupted);
  EXPECT_EQ(observer.count("frame"), 12U);
  EXPECT_TRUE(observer.is_monotone());
  EXPECT_NE(observer.steps.back().note.find(std::to_string(counts.num_keyframes) + " keyframes"), std::string::npos);
  EXPECT_EQ(counts.num_views, 12U);
  EXPECT_EQ(counts.num_lost, 0U);
  EXPECT_EQ(end->surfaces.size(), counts.num_keyframes);
  auto reader = FrameLogReader::open(request.log_path, recording_identity(request));
  ASSERT_TRUE(reader.is_ok());
  LoggedFrame view;
  for (std::uint64_t frame = 0; frame < 12; ++frame) {
    ASSERT_TRUE(reader->next(&view).is_ok());
    EXPECT_EQ(view.frame, frame);
    EXPECT_GE(view.view.size(), 100U);
    EXPECT_FALSE(view.surface_m.empty());
  }
  EXPECT_EQ(reader->next(&view).code(), ErrorCode::kEnd);
}

TEST(RecordingTracking, ResumingAWholeLogReadsNoFrameAgain) {
  const TestFolder folder;
  record_room(folder / "walk", 12);
  TrackingRequest request = request_for(folder);
  SlamCounts first, again;
  ASSERT_TRUE(track(request, &first).is_ok());
  const auto log = bytes_of(request.log_path);
  request.is_resumed = true;
  const auto end = track(request, &again);
  ASSERT_TRUE(end.is_ok()) << end.status().message();
  EXPECT_EQ(end->num_resumed, 12U);
  EXPECT_EQ(again.num_views, 12U);
  EXPECT_EQ(again.num_keyframes, first.num_keyframes);
  EXPECT_EQ(again.num_landmarks, first.num_landmarks);
  EXPECT_EQ(bytes_of(request.log_path), log);
}

TEST(RecordingTracking, AnInterruptWhileTheLogIsReadKeepsTheLog) {
  const TestFolder folder;
  record_room(folder / "walk", 12);
  TrackingRequest request = request_for(folder);
  ASSERT_TRUE(track(request).is_ok());
  const auto log = bytes_of(request.log_path);
  request.is_resumed = true;
  testing::RecordingObserver stops_at_once(0);
  const auto end = track(request, nullptr, stops_at_once);
  ASSERT_TRUE(end.is_ok());
  EXPECT_TRUE(end->is_interrupted);
  EXPECT_EQ(bytes_of(request.log_path), log);
}

TEST(RecordingTracking, FramesOfAnotherSizeEndItAndLeaveNoLog) {
  const TestFolder folder;
  record_room(folder / "walk", 6, [](std::uint64_t, FrameBuffer* buffer) { buffer->gray.resize(160, 120); });
  const auto end = track(request_for(folder));
  ASSERT_FALSE(end.is_ok());
  EXPECT_EQ(end.status().code(), ErrorCode::kInvalid);
  EXPECT_NE(end.status().message().find("160x120"), std::string::npos) << end.status().message();
  EXPECT_FALSE(std::filesystem::exists(folder / "log"));
}

TEST(RecordingTracking, TheIdentityChangesWithRecordingCameraAndFeatures) {
  const TestFolder folder;
  const TrackingRequest request = request_for(folder);
  const std::uint64_t identity = recording_identity(request);
  EXPECT_EQ(recording_identity(request), identity);
  TrackingRequest other = request;
  other.url += "?frames=0:10:1";
  EXPECT_NE(recording_identity(other), identity);
  other = request;
  other.camera.depth.fx += 0.5;
  other.camera.color.fx += 0.5;
  EXPECT_NE(recording_identity(other), identity);
  other = request;
  other.orb.num_features += 1;
  EXPECT_NE(recording_identity(other), identity);
  // Where the log lies does not matter.
  other = request;
  other.log_path = "elsewhere";
  EXPECT_EQ(recording_identity(other), identity);
}

RgbdCamera surface_camera() {
  RgbdCamera camera;
  camera.color.width = camera.depth.width = 160;
  camera.color.height = camera.depth.height = 120;
  camera.color.fx = camera.color.fy = camera.depth.fx = camera.depth.fy = 130;
  camera.color.cx = camera.depth.cx = 79.5;
  camera.color.cy = camera.depth.cy = 59.5;
  return camera;
}

TEST(SurfaceSample, PointsLieOnTheSurface) {
  const RgbdCamera camera = surface_camera();
  Image<std::uint16_t> depth;
  depth.resize(160, 120);
  std::fill(depth.pixels.begin(), depth.pixels.end(), std::uint16_t{2000});
  const auto points = sample_surface(camera, depth.view());
  ASSERT_EQ(points.size(), 300U);
  for (const Eigen::Vector3f& p : points) {
    EXPECT_FLOAT_EQ(p.z(), 2);
    EXPECT_LT(std::abs(p.x()), 2 * 80.0F / 130);
    EXPECT_LT(std::abs(p.y()), 2 * 60.0F / 130);
  }
  // Evenly, up to the border: the first and last are mirror images but for the centre of the pixel.
  EXPECT_NEAR(points.front().x(), -points.back().x(), 0.03);
  EXPECT_NEAR(points.front().y(), -points.back().y(), 0.03);
}

TEST(SurfaceSample, HolesAreLeftOut) {
  const RgbdCamera camera = surface_camera();
  Image<std::uint16_t> depth;
  depth.resize(160, 120);
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) depth.at(x, y) = x < 80 ? 0 : (y < 60 ? 65535 : 1500);
  }
  const auto points = sample_surface(camera, depth.view());
  EXPECT_EQ(points.size(), 80U);
  for (const Eigen::Vector3f& p : points) EXPECT_TRUE(p.x() > 0 && p.y() > 0);
  std::fill(depth.pixels.begin(), depth.pixels.end(), std::uint16_t{0});
  EXPECT_TRUE(sample_surface(camera, depth.view()).empty());
}

TEST(SurfaceSample, PointsAreInTheFrameOfTheColourCamera) {
  RgbdCamera camera = surface_camera();
  camera.is_depth_registered = false;
  camera.T_color_depth = {exp_so3({0, 0.1, 0}), {0.025, 0, 0.01}};
  Image<std::uint16_t> depth;
  depth.resize(160, 120);
  std::fill(depth.pixels.begin(), depth.pixels.end(), std::uint16_t{2000});
  for (const Eigen::Vector3f& p : sample_surface(camera, depth.view()))
    EXPECT_NEAR((camera.T_color_depth.inverse() * p.cast<double>()).z(), 2, 1e-5);
}

}  // namespace
}  // namespace camloc::mapping
