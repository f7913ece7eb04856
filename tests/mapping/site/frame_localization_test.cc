// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Frames with picked pixels, localized in a map of their room; what cannot be localized says why.
#include <gtest/gtest.h>

#include <map>

#include "core/io/camera_file.h"
#include "core/io/image_writer.h"
#include "tests/base/recording_observer.h"
#include "tests/localize/sample_world.h"
#include "tests/mapping/sample_recording.h"
#include "tools/mapping/site/control_points.h"

namespace camloc::mapping {
namespace {

using testing::SampleWorld;

std::vector<ControlObservation> pixels() {
  const auto observations =
      parse_control_observations("A pixel 10 80 60\nA pixel 20 240 70\nB pixel 20 60 180\nC map 1 2 3\nD pixel 99 5 5\n", "o");
  EXPECT_TRUE(observations.is_ok());
  return *observations;
}

TEST(FrameLocalization, FindsTheFramesThatHavePixels) {
  const SampleRecording recording(25);
  const SampleWorld& world = SampleWorld::get();
  const auto frames = localize_frames(world.map(), world.camera(), recording.folder.path(), pixels(), WorkObserver::nobody());
  ASSERT_TRUE(frames.is_ok()) << frames.status().message();
  ASSERT_EQ(frames->size(), 3U);
  for (const std::uint64_t frame : {10U, 20U}) {
    const LocalizedFrame& found = frames->at(frame);
    ASSERT_TRUE(found.T_map_camera.is_ok()) << found.T_map_camera.status().message();
    EXPECT_LT((found.T_map_camera->pose.translation - sample_pose(frame).translation).norm(), 0.03) << frame;
  }
  EXPECT_EQ(frames->at(10).measurements.size(), 1U);
  EXPECT_EQ(frames->at(20).measurements.size(), 2U);
  EXPECT_EQ(frames->at(99).T_map_camera.status().code(), ErrorCode::kNotFound);
}

TEST(FrameLocalization, WithoutPixelsNothingIsOpened) {
  const SampleWorld& world = SampleWorld::get();
  const auto none = localize_frames(world.map(), world.camera(), "/nowhere", {pixels()[3]}, WorkObserver::nobody());
  ASSERT_TRUE(none.is_ok());
  EXPECT_TRUE(none->empty());
  EXPECT_FALSE(localize_frames(world.map(), world.camera(), "/nowhere", pixels(), WorkObserver::nobody()).is_ok());
}

TEST(FrameLocalization, IsStoppedAndRefusesAnotherCamera) {
  const SampleRecording recording(12);
  const SampleWorld& world = SampleWorld::get();
  const testing::RecordingObserver stops(0);
  const auto stopped = localize_frames(world.map(), world.camera(), recording.folder.path(), pixels(), stops);
  EXPECT_EQ(stopped.status().code(), ErrorCode::kIo);
  EXPECT_NE(stopped.status().message().find("nothing was written"), std::string::npos);
  RgbdCamera other = world.camera();
  other.color.width = 64;
  const auto refused = localize_frames(world.map(), other, recording.folder.path(), pixels(), WorkObserver::nobody());
  EXPECT_EQ(refused.status().code(), ErrorCode::kInvalid);
  EXPECT_NE(refused.status().message().find("--camera is for 64x"), std::string::npos) << refused.status().message();
}

}  // namespace
}  // namespace camloc::mapping
