// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "tests/tools/command_runner.h"
#include "tests/tools/fake_daemon.h"
#include "tools/camloc/commands.h"

namespace camloc::tools {
namespace {

using nlohmann::json;

/// A machine with nothing but a configuration file and, in PATH, a camlocd that says about it what the test wants.
class DoctorTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* path = std::getenv("PATH");
    old_path_ = path == nullptr ? "" : path;
    ::setenv("PATH", (folder_.path() + ":" + old_path_).c_str(), 1);
  }
  void TearDown() override { ::setenv("PATH", old_path_.c_str(), 1); }

  void install_camlocd(const std::string& check_script, const std::string& printed_config) const {
    const std::string printed = folder_.write("printed.toml", printed_config);
    (void)folder_.write(
        "camlocd",
        "#!/bin/sh\nfor last; do :; done\nif [ \"$last\" = --print-config ]; then cat " + printed + "; else " + check_script + "; fi\n",
        true);
  }
  /// The answer as JSON and the exit code.
  [[nodiscard]] std::pair<json, int> examine(std::vector<std::string> options = {}) const {
    options.insert(options.begin(), {"doctor", "--json", "--config", config_path_});
    const CommandOutput output = run_command(add_doctor_command, options);
    return {json::parse(output.out), output.exit_code};
  }
  static json check(const json& document, const std::string& name) {
    for (const auto& entry : document["checks"]) {
      if (entry["name"] == name) return entry;
    }
    return {};
  }

  TemporaryFolder folder_;
  std::string config_path_ = folder_.write("camlocd.toml", "[map]\npath = \"/maps/a.cmap\"\n");
  std::string old_path_;
};

TEST_F(DoctorTest, WhatIsMissingFailsWithAdvice) {
  install_camlocd("exit 0", "[map]\npath = \"" + (folder_ / "none.cmap") + "\"\n[source]\nurl = \"replay://" + (folder_ / "none") +
                                "\"\n[control]\nsocket = \"" + (folder_ / "none.sock") + "\"\n[publish]\nlcm_url = \"file://x\"\n");
  const auto [document, exit_code] = examine();
  EXPECT_EQ(exit_code, 1);
  EXPECT_EQ(document["ok"], false);
  EXPECT_EQ(check(document, "config")["level"], "ok");
  EXPECT_EQ(check(document, "daemon")["level"], "warn");
  EXPECT_NE(check(document, "daemon")["detail"].get<std::string>().find("none.sock"), std::string::npos);
  for (const char* name : {"map", "camera"}) {
    EXPECT_EQ(check(document, name)["level"], "fail") << name;
    EXPECT_NE(check(document, name)["detail"].get<std::string>().find("none"), std::string::npos) << name;
    EXPECT_FALSE(check(document, name)["advice"].get<std::string>().empty()) << name;
  }
  EXPECT_EQ(check(document, "lcm")["level"], "ok");
  EXPECT_EQ(check(document, "memory").is_null(), false);
  EXPECT_EQ(check(document, "cpu").is_null(), false);
}

TEST_F(DoctorTest, TheLineThatCamlocdRefusesIsShown) {
  install_camlocd("echo 'camlocd.toml:2: map.pat: unknown key' >&2; exit 2", "");
  const auto [document, exit_code] = examine();
  EXPECT_EQ(exit_code, 1);
  EXPECT_EQ(check(document, "config")["level"], "fail");
  EXPECT_EQ(check(document, "config")["detail"], "camlocd.toml:2: map.pat: unknown key");
}

TEST_F(DoctorTest, AMissingConfigurationIsNamed) {
  config_path_ = folder_ / "absent.toml";
  const auto [document, exit_code] = examine();
  EXPECT_EQ(exit_code, 1);
  EXPECT_NE(check(document, "config")["detail"].get<std::string>().find("absent.toml does not exist"), std::string::npos);
}

TEST_F(DoctorTest, TheCommandLineOverrulesTheConfiguration) {
  install_camlocd("exit 0", "[publish]\nlcm_url = \"file://x\"\n");
  const auto [document, exit_code] =
      examine({"--lcm-url", "nonsense", "--map", folder_ / "other.cmap", "--camera", folder_ / "camera.toml"});
  EXPECT_EQ(exit_code, 1);
  EXPECT_EQ(check(document, "lcm")["level"], "fail");
  EXPECT_NE(check(document, "map")["detail"].get<std::string>().find("other.cmap"), std::string::npos);
  EXPECT_EQ(check(document, "calibration")["level"], "fail");
}

TEST_F(DoctorTest, ALiveSourceIsAskedForAFrame) {
  install_camlocd("exit 0", "");
  const auto [document, exit_code] = examine({"--source", "sample://"});
  EXPECT_EQ(check(document, "camera")["level"], "ok") << check(document, "camera").dump();
}

TEST_F(DoctorTest, ARunningDaemonIsBelieved) {
  install_camlocd("exit 0", "");
  FakeDaemon daemon(folder_ / "control.sock",
                    "{\"ok\":true,\"state\":\"NO_CAMERA\",\"is_calibration_suspect\":true,\"focal_scale\":1.17}\n");
  const auto [document, exit_code] = examine({"--socket", folder_ / "control.sock", "--source", "v4l2:///dev/video0"});
  EXPECT_EQ(check(document, "daemon")["level"], "ok");
  EXPECT_EQ(check(document, "camera")["level"], "fail");  // not opened: it belongs to the daemon, which gets no frames from it
  EXPECT_EQ(check(document, "calibration")["level"], "warn");
  EXPECT_NE(check(document, "calibration")["detail"].get<std::string>().find("1.17"), std::string::npos);
}

TEST_F(DoctorTest, TextHasALineACheck) {
  install_camlocd("exit 0", "");
  const CommandOutput output = run_command(add_doctor_command, {"doctor", "--config", config_path_, "--lcm-url", "file://x"});
  EXPECT_EQ(output.exit_code, 1);
  EXPECT_NE(output.out.find("ok    config       " + config_path_), std::string::npos) << output.out;
  EXPECT_NE(output.out.find("FAIL  map          none configured"), std::string::npos) << output.out;
  EXPECT_NE(output.out.find("-> build one with 'camloc map build'"), std::string::npos) << output.out;
}

}  // namespace
}  // namespace camloc::tools
