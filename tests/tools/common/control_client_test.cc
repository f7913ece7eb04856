// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The control socket, with a daemon that says what the test wants.
#include "tools/common/control_client.h"

#include <gtest/gtest.h>

#include "tests/tools/command_runner.h"
#include "tests/tools/fake_daemon.h"

namespace camloc::tools {
namespace {

class ControlClientTest : public ::testing::Test {
 protected:
  TemporaryFolder folder_;
};

TEST_F(ControlClientTest, WhatIsNoJsonObjectIsRefused) {
  for (const char* answer : {"hello\n", "[1,2]\n", "\n", "{\"ok\":\n"}) {
    const std::string path = folder_ / "other.sock";
    FakeDaemon daemon(path, answer);
    const auto result = control_request(path, "status", std::chrono::seconds(5));
    ASSERT_FALSE(result.is_ok()) << answer;
    EXPECT_EQ(result.status().code(), ErrorCode::kCorrupt) << answer;
    daemon.stop();
    std::filesystem::remove(path);
  }
}

TEST_F(ControlClientTest, TheAnswerKeepsItsOrder) {
  FakeDaemon daemon(folder_ / "s", "{\"z\":1,\"a\":2}\nmore\n");
  const auto answer = control_request(folder_ / "s", "status", std::chrono::seconds(5));
  ASSERT_TRUE(answer.is_ok()) << answer.status().message();
  EXPECT_EQ(answer->dump(), "{\"z\":1,\"a\":2}");
  EXPECT_EQ(daemon.stop(), "status\n");
}

TEST_F(ControlClientTest, NobodyThereAndNoAnswerAreToldApart) {
  EXPECT_EQ(control_request(folder_ / "s", "status", std::chrono::seconds(1)).status().code(), ErrorCode::kUnavailable);
  EXPECT_EQ(control_request("", "status", std::chrono::seconds(1)).status().code(), ErrorCode::kInvalid);
  EXPECT_EQ(control_request(std::string(108, 'x'), "status", std::chrono::seconds(1)).status().code(), ErrorCode::kInvalid);
  FakeDaemon daemon(folder_ / "t", "");
  EXPECT_EQ(control_request(folder_ / "t", "status", std::chrono::milliseconds(50)).status().code(), ErrorCode::kTimeout);
}

}  // namespace
}  // namespace camloc::tools
