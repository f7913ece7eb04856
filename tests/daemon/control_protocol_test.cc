// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Requests and replies as text.
#include "daemon/control_protocol.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

namespace camloc {
namespace {

TEST(ControlProtocolTest, CommandsAreUnderstood) {
  EXPECT_EQ(parse_control_request("status").value().command, ControlCommand::kStatus);
  EXPECT_EQ(parse_control_request(" reload\r").value().command, ControlCommand::kReload);
  EXPECT_EQ(parse_control_request("\treset ").value().command, ControlCommand::kReset);
}

TEST(ControlProtocolTest, AnythingElseIsRefusedWithTheList) {
  for (const char* line : {"", " ", "Status", "status now", "statu", "reload\n", "{}"}) {
    const Result<ControlRequest> command = parse_control_request(line);
    ASSERT_FALSE(command) << line;
    EXPECT_NE(command.status().message().find("one of status, reload, reset"), std::string::npos);
  }
  EXPECT_LT(parse_control_request(std::string(100000, 'x')).status().message().size(), 200U);
}

TEST(ControlProtocolTest, HintsAreInMetresAndDegrees) {
  const Result<ControlRequest> request = parse_control_request(" hint 1.5 -2 0.25\t90 3e0\r");
  ASSERT_TRUE(request) << request.status().message();
  EXPECT_EQ(request->command, ControlCommand::kHint);
  EXPECT_EQ(request->hint.position_m, Eigen::Vector3d(1.5, -2, 0.25));
  EXPECT_DOUBLE_EQ(request->hint.yaw_rad, std::numbers::pi / 2);
  EXPECT_EQ(request->hint.radius_m, 3);
}

TEST(ControlProtocolTest, HintsThatMeanNothingAreRefused) {
  for (const char* line : {"hint", "hint 1 2 3 4", "hint 1 2 3 4 5 6", "hint 1 2 3 4 x", "hint 1 2 3 4 5m"})
    EXPECT_NE(parse_control_request(line).status().message().find("five numbers"), std::string::npos) << line;
  for (const char* line : {"hint nan 2 3 4 5", "hint 1 inf 3 4 5", "hint 1 2 3 nan 5", "hint 1 2 3 4 nan", "hint 1 2 3 4 0",
                           "hint 1 2 3 4 -1", "hint 1 2 3 4 21", "hint 1 2 3 1e308 1e308"})
    EXPECT_NE(parse_control_request(line).status().message().find("at most 20 m"), std::string::npos) << line;
  EXPECT_FALSE(parse_control_request("hints 1 2 3 4 5"));
}

TEST(ControlProtocolTest, RepliesAreJsonWhateverTheText) {
  EXPECT_EQ(control_reply(Status::ok()), "{\"ok\":true}");
  EXPECT_EQ(control_reply(Status(ErrorCode::kInvalid, "a \"b\" \\ \n\x01\xff")),
            "{\"ok\":false,\"error\":\"a \\\"b\\\" \\\\ \\u000a\\u0001\\u00ff\"}");
}

TEST(ControlProtocolTest, StatusNamesEveryField) {
  DaemonStatus status;
  status.state = State::kLocalized;
  status.state_text = "fine";
  status.map_id = 0xffffffffffffffff;
  status.frames_received = std::numeric_limits<std::int64_t>::max();
  status.latency_p50_ms = 1.25;
  status.focal_scale = std::numeric_limits<double>::quiet_NaN();
  const std::string reply = control_reply(status);
  EXPECT_EQ(reply.find('\n'), std::string::npos);
  for (const char* part :
       {"\"ok\":true", "\"state\":\"LOCALIZED\"", "\"state_text\":\"fine\"", "\"map_id\":\"ffffffffffffffff\"",
        "\"frames_received\":9223372036854775807", "\"latency_p50_ms\":1.25", "\"focal_scale\":null", "\"is_calibration_suspect\":false",
        "\"source\":\"\"", "\"uptime_us\":0", "\"coarse_state\":\"off\"", "\"coarse_answers\":0", "\"fixes_by_hint\":0",
        "\"fixes_by_retrieval\":0", "\"fixes_by_coarse\":0", "\"rss_bytes\":0", "\"log_lines_lost\":0"}) {
    EXPECT_NE(reply.find(part), std::string::npos) << part << " not in " << reply;
  }
}

}  // namespace
}  // namespace camloc
