// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The monitor reads LCM logs like a network: every test records its own.
#include <lcm/lcm-cpp.hpp>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/tools/command_runner.h"
#include "tools/camloc/commands.h"
#include "tools/monitor/monitor_view.h"

namespace camloc::tools {
namespace {

using nlohmann::json;

pose_t make_pose(std::int8_t state) {
  pose_t pose{};
  pose.utime = 1'700'000'000'250'000;
  pose.parent_frame = "map";
  pose.child_frame = "camera";
  pose.state = state;
  pose.pos[0] = 1.5;
  pose.orientation[0] = 1;
  for (int i = 0; i < 6; ++i) pose.covariance[7 * i] = i < 3 ? 1e-4 : 1e-6;
  pose.covariance[7] = 4e-4;  // y: 2 cm
  pose.quality = 80;
  pose.num_matches = 100;
  pose.num_inliers = 60;
  pose.latency_us[5] = 6500;
  pose.age_us = -1;
  pose.map_id = static_cast<std::int64_t>(0xfedcba9876543210ULL);
  return pose;
}

status_t make_status() {
  status_t status{};
  status.state = pose_t::LOCALIZED;
  status.state_text = "tracking";
  status.source = "replay://walk";
  status.map_path = "/maps/a.cmap";
  status.focal_scale = 1.17;
  return status;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

class MonitorTest : public ::testing::Test {
 protected:
  /// Three poses, the second lost, and one status.
  void record() const {
    lcm::LCM log("file://" + log_path_ + "?mode=w");
    ASSERT_TRUE(log.good());
    const status_t status = make_status();
    pose_t lost = make_pose(pose_t::LOST);
    lost.reason_text = "few matches";
    const pose_t pose = make_pose(pose_t::LOCALIZED);
    log.publish("CAMLOC_STATUS", &status);
    log.publish("CAMLOC_POSE", &pose);
    log.publish("CAMLOC_POSE", &lost);
    log.publish("CAMLOC_POSE", &pose);
  }
  [[nodiscard]] CommandOutput monitor(std::vector<std::string> options) const {
    options.insert(options.begin(), {"monitor", "--lcm-url", "file://" + log_path_ + "?mode=r&speed=0", "--timeout", "5"});
    return run_command(add_monitor_command, options);
  }

  TemporaryFolder folder_;
  std::string log_path_ = folder_ / "log";
};

TEST_F(MonitorTest, PrintsOneLineAPose) {
  record();
  const CommandOutput output = monitor({"--count", "3"});
  EXPECT_EQ(output.exit_code, 0) << output.err;
  const auto lines = lines_of(output.out);
  ASSERT_EQ(lines.size(), 4U) << output.out;
  EXPECT_EQ(lines[0].rfind("status LOCALIZED", 0), 0U) << lines[0];
  EXPECT_NE(lines[1].find("LOCALIZED  map [+1.500 +0.000 +0.000] m  sigma 2.0 cm"), std::string::npos) << lines[1];
  EXPECT_NE(lines[2].find("LOST       few matches"), std::string::npos) << lines[2];
}

TEST_F(MonitorTest, JsonIsOneObjectALine) {
  record();
  const CommandOutput output = monitor({"--count", "3", "--json"});
  EXPECT_EQ(output.exit_code, 0) << output.err;
  const auto lines = lines_of(output.out);
  ASSERT_EQ(lines.size(), 4U);
  EXPECT_EQ(json::parse(lines[0])["type"], "status");
  const json pose = json::parse(lines[1]);
  EXPECT_EQ(pose["type"], "pose");
  EXPECT_EQ(pose["state_name"], "LOCALIZED");
  EXPECT_EQ(pose["quality"], 80);
  EXPECT_EQ(pose["map_id"], "fedcba9876543210");
  EXPECT_EQ(pose["latency_us"]["total"], 6500);
  EXPECT_EQ(pose["covariance"].size(), 36U);
}

TEST_F(MonitorTest, CountEndsIt) {
  record();
  EXPECT_EQ(lines_of(monitor({"--count", "1", "--json"}).out).size(), 2U);  // the status came first
}

TEST_F(MonitorTest, AnEndedLogWithFewerPosesIsAFailure) {
  record();
  const CommandOutput output = monitor({"--count", "4"});
  EXPECT_EQ(output.exit_code, 1);
  EXPECT_NE(output.err.find("3 poses"), std::string::npos) << output.err;
}

TEST_F(MonitorTest, MessagesOfAnotherTypeAreSkippedAndNamedOnce) {
  {
    lcm::LCM log("file://" + log_path_ + "?mode=w");
    const status_t other = make_status();
    const pose_t pose = make_pose(pose_t::LOCALIZED);
    log.publish("CAMLOC_POSE", &other);
    log.publish("CAMLOC_POSE", "xyz", 3);
    log.publish("CAMLOC_POSE", &pose);
  }
  const CommandOutput output = monitor({"--count", "1"});
  EXPECT_EQ(output.exit_code, 0);
  EXPECT_EQ(lines_of(output.out).size(), 1U);
  EXPECT_EQ(lines_of(output.err).size(), 1U) << output.err;
  EXPECT_NE(output.err.find("CAMLOC_POSE"), std::string::npos);
}

TEST(MonitorSilenceTest, SaysWhatToCheck) {
  const CommandOutput output = run_command(add_monitor_command, {"monitor", "--lcm-url", "memq://", "--timeout", "0.2"});
  EXPECT_EQ(output.exit_code, 1);
  EXPECT_NE(output.err.find("no pose on CAMLOC_POSE"), std::string::npos);
  EXPECT_NE(output.err.find("camloc doctor"), std::string::npos);
}

TEST(MonitorSilenceTest, RefusesWhatIsNoUrl) {
  EXPECT_EQ(run_command(add_monitor_command, {"monitor", "--lcm-url", "tcp://x"}).exit_code, 2);
  EXPECT_EQ(run_command(add_monitor_command, {"monitor", "--count", "-1"}).exit_code, 2);
}

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
  const json record = status_json(status);
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
