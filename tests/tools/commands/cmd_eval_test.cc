// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// `camloc eval` as a command: numbers, picture, usage.
#include <nlohmann/json.hpp>

#include "tests/tools/command_runner.h"
#include "tools/camloc/commands.h"

namespace camloc::tools {
namespace {

constexpr const char* kReference = "1 0 0 0 0 0 0 1\n1.05 0.5 0 0 0 0 0 1\n1.1 1 0 0 0 0 0 1\n";
constexpr const char* kEstimate = "# frames 4\n1 0.01 0 0 0 0 0 1\n1.1 1.5 0 0 0 0 0 1\n";

TEST(EvalCommandTest, CountsAllFramesThatWereTried) {
  const TemporaryFolder folder;
  const std::string png = folder / "view.png";
  const CommandOutput output = run_command(add_eval_command, {"eval", "--estimate", folder.write("e.tum", kEstimate), "--reference",
                                                              folder.write("r.tum", kReference), "--png", png, "--json"});
  ASSERT_EQ(output.exit_code, 0) << output.err;
  const auto report = nlohmann::json::parse(output.out);
  EXPECT_EQ(report["frames"], 4);
  EXPECT_EQ(report["localized"], 2);
  EXPECT_EQ(report["misleading"], 1);
  EXPECT_DOUBLE_EQ(report["within"]["2cm_2deg"], 0.25);
  EXPECT_NEAR(report["translation_m"]["max"].get<double>(), 0.5, 1e-9);
  EXPECT_TRUE(std::filesystem::exists(png));
}

TEST(EvalCommandTest, AnotherRecordingIsAnError) {
  const TemporaryFolder folder;
  const CommandOutput output = run_command(add_eval_command, {"eval", "--estimate", folder.write("e.tum", "90 0 0 0 0 0 0 1\n"),
                                                              "--reference", folder.write("r.tum", kReference)});
  EXPECT_EQ(output.exit_code, 2);
  EXPECT_NE(output.err.find("same recording"), std::string::npos) << output.err;
  EXPECT_EQ(output.out, "");
}

TEST(EvalCommandTest, AMapWithoutAPictureIsAMistake) {
  EXPECT_EQ(run_command(add_eval_command, {"eval", "--estimate", "e", "--reference", "r", "--map", "m"}).exit_code, 2);
}

}  // namespace
}  // namespace camloc::tools
