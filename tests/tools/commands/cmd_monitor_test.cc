// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The monitor reads LCM logs like a network: every test records its own.
#include <lcm/lcm-cpp.hpp>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/tools/command_runner.h"
#include "tests/tools/messages.h"
#include "tools/camloc/commands.h"

namespace camloc::tools {
namespace {

using nlohmann::json;

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

}  // namespace
}  // namespace camloc::tools
