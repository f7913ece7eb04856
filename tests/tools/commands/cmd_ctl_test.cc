// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "tests/tools/command_runner.h"
#include "tests/tools/fake_daemon.h"
#include "tools/camloc/commands.h"

namespace camloc::tools {
namespace {

class CtlTest : public ::testing::Test {
 protected:
  [[nodiscard]] CommandOutput ctl(std::vector<std::string> options) const {
    options.insert(options.begin(), "ctl");
    options.insert(options.end(), {"--socket", socket_path_});
    return run_command(add_ctl_command, options);
  }

  TemporaryFolder folder_;
  std::string socket_path_ = folder_ / "control.sock";
};

TEST_F(CtlTest, StatusIsATable) {
  FakeDaemon daemon(socket_path_, "{\"ok\":true,\"state\":\"LOCALIZED\",\"frame_rate_hz\":29.9,\"map\":{\"id\":\"ab\"}}\n");
  const CommandOutput output = ctl({"status"});
  EXPECT_EQ(output.exit_code, 0) << output.err;
  EXPECT_EQ(daemon.stop(), "status\n");
  EXPECT_NE(output.out.find("state                      LOCALIZED\n"), std::string::npos) << output.out;
  EXPECT_NE(output.out.find("map.id                     ab\n"), std::string::npos) << output.out;
  EXPECT_EQ(output.out.find("ok "), std::string::npos) << output.out;
}

TEST_F(CtlTest, JsonIsTheAnswer) {
  FakeDaemon daemon(socket_path_, "{\"ok\":true,\"state\":\"LOST\"}");  // the stream ends without a line feed
  const CommandOutput output = ctl({"status", "--json"});
  EXPECT_EQ(output.exit_code, 0) << output.err;
  EXPECT_EQ(nlohmann::json::parse(output.out)["state"], "LOST");
}

TEST_F(CtlTest, ARefusedReloadIsAFailureWithTheReason) {
  FakeDaemon daemon(socket_path_, "{\"ok\":false,\"error\":\"b.cmap: checksum\"}\n");
  const CommandOutput output = ctl({"reload"});
  EXPECT_EQ(output.exit_code, 1);
  EXPECT_EQ(daemon.stop(), "reload\n");
  EXPECT_EQ(output.err, "camloc: reload refused: b.cmap: checksum\n");
}

TEST_F(CtlTest, ResetIsDone) {
  FakeDaemon daemon(socket_path_, "{\"ok\":true}\n");
  const CommandOutput output = ctl({"reset"});
  EXPECT_EQ(output.exit_code, 0);
  EXPECT_EQ(output.out, "reset: done\n");
}

TEST_F(CtlTest, AHintIsOneLine) {
  FakeDaemon daemon(socket_path_, "{\"ok\":true}\n");
  const CommandOutput output = ctl({"hint", "1.5", "-2", "-0.25", "-90", "3"});
  EXPECT_EQ(output.exit_code, 0) << output.err;
  EXPECT_EQ(output.out, "hint: done\n");
  EXPECT_EQ(daemon.stop(), "hint 1.5 -2 -0.25 -90 3\n");
}

TEST_F(CtlTest, ARefusedHintIsAFailure) {
  FakeDaemon daemon(socket_path_, "{\"ok\":false,\"error\":\"no map is open\"}\n");
  const CommandOutput output = ctl({"hint", "1", "2", "3", "4", "5"});
  EXPECT_EQ(output.exit_code, 1);
  EXPECT_EQ(output.err, "camloc: hint refused: no map is open\n");
  EXPECT_EQ(ctl({"hint", "1", "2", "3", "4"}).exit_code, 2);
  EXPECT_EQ(ctl({"hint", "1", "2", "3", "4", "x"}).exit_code, 2);
}

TEST_F(CtlTest, NoDaemonIsOneClearLine) {
  const CommandOutput output = ctl({"status"});
  EXPECT_EQ(output.exit_code, 1);
  EXPECT_NE(output.err.find("no camlocd listens on " + socket_path_), std::string::npos) << output.err;
  EXPECT_EQ(std::count(output.err.begin(), output.err.end(), '\n'), 1);
}

TEST_F(CtlTest, SilenceTimesOut) {
  FakeDaemon daemon(socket_path_, "");
  const CommandOutput output = ctl({"status", "--timeout-ms", "100"});
  EXPECT_EQ(output.exit_code, 1);
  EXPECT_NE(output.err.find("did not answer"), std::string::npos) << output.err;
}

TEST_F(CtlTest, UsageErrors) {
  EXPECT_EQ(ctl({"explode"}).exit_code, 2);
  EXPECT_EQ(ctl({}).exit_code, 2);
  EXPECT_EQ(run_command(add_ctl_command, {"ctl", "status", "--socket", std::string(200, 'x')}).exit_code, 2);
}

}  // namespace
}  // namespace camloc::tools
