// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Messages as lines, as JSON and as a screen.
#include "tools/monitor/monitor_view.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/tools/messages.h"

namespace camloc::tools {
namespace {

TEST(MonitorViewTest, SigmaIsTheLargestOverAllDirections) {
  pose_t pose = make_pose(pose_t::LOCALIZED);
  pose.covariance[0] = pose.covariance[7] = 1e-4;  // fully correlated x and y: sigma of their sum direction
  pose.covariance[1] = pose.covariance[6] = 1e-4;
  EXPECT_NEAR(pose_sigma(pose).position_m, std::sqrt(2e-4), 1e-9);
  EXPECT_NEAR(pose_sigma(pose).rotation_rad, 1e-3, 1e-9);
}

TEST(MonitorViewTest, ControlBytesDoNotReachTheTerminal) {
  pose_t pose = make_pose(pose_t::LOST);
  pose.reason_text = "\x1b[2Jgone";
  EXPECT_EQ(pose_line(pose).find('\x1b'), std::string::npos);
  MonitorState state;
  state.pose = pose;
  EXPECT_EQ(monitor_screen(state).find('\x1b'), std::string::npos);
}

TEST(MonitorViewTest, UnknownStateHasANumber) { EXPECT_EQ(state_name(42), "state 42"); }

TEST(MonitorViewTest, ScreenWarnsOfASuspectCalibrationAndOfSilence) {
  MonitorState state;
  state.pose = make_pose(pose_t::LOCALIZED);
  state.status = make_status();
  EXPECT_EQ(monitor_screen(state).find("WARNING"), std::string::npos) << monitor_screen(state);
  state.status->is_calibration_suspect = 1;
  state.seconds_since_pose = 4;
  const std::string screen = monitor_screen(state);
  EXPECT_NE(screen.find("calibration suspect"), std::string::npos) << screen;
  EXPECT_NE(screen.find("1.170 times"), std::string::npos) << screen;
  EXPECT_NE(screen.find("no pose for 4 s"), std::string::npos) << screen;
}

TEST(MonitorViewTest, ScreenShowsCameraRecoveryAndStages) {
  MonitorState state;
  state.pose = make_pose(pose_t::LOCALIZED);
  for (int i = 0; i < 400; ++i) {
    pose_t pose = make_pose(pose_t::LOCALIZED);
    pose.latency_us[0] = i < 100 ? 90000 : 2500;  // the first hundred have left the window
    state.latencies.add(pose);
  }
  state.status = make_status();
  state.status->camera_state = "stalled";
  state.status->frames_received = 1234;
  state.status->packets_lost = 17;
  state.status->stream_restarts = 2;
  state.status->last_recovery_ms = 812;
  state.status->clock_drift_ppm = -12.5;
  state.sketch = "  o.o\n";
  const std::string screen = monitor_screen(state);
  for (const char* part : {"stalled, replay://walk", "1234 received", "17 packets lost", "2 stream restarts", "the last took 812 ms",
                           "clock -12.5 ppm", "WARNING   the camera is silent", "extract", "  o.o\n"}) {
    EXPECT_NE(screen.find(part), std::string::npos) << part << "\n" << screen;
  }
  EXPECT_EQ(state.latencies.of(0).median_ms, 2.5);
  EXPECT_EQ(state.latencies.of(0).p99_ms, 2.5);
  EXPECT_EQ(state.latencies.of(5).median_ms, 6.5);
  EXPECT_EQ(StageLatencies().of(0).median_ms, 0);
}

TEST(MonitorViewTest, JsonHasEveryFieldOfTheCamera) {
  status_t status = make_status();
  status.camera_state = "streaming";
  status.frames_unpaired = 4;
  const auto record = status_json(status);
  EXPECT_EQ(record["camera_state"], "streaming");
  EXPECT_EQ(record["frames_unpaired"], 4);
  for (const char* key : {"camera_stalls", "stream_restarts", "device_reopens", "device_resets", "last_recovery_ms", "packets_lost",
                          "frames_incomplete", "clock_drift_ppm"}) {
    EXPECT_TRUE(record.contains(key)) << key;
  }
}

TEST(MonitorViewTest, NoPositionIsShownWithoutAPose) {
  for (const std::int8_t pose_state : {pose_t::NO_CAMERA, pose_t::NO_MAP, pose_t::LOST, pose_t::COARSE}) {
    EXPECT_EQ(pose_line(make_pose(pose_state)).find("+1.500"), std::string::npos) << static_cast<int>(pose_state);
  }
}

}  // namespace
}  // namespace camloc::tools
