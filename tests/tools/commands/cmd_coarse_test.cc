// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// `camloc coarse` on a model of the sample room, and what the other commands do with one.
#include <nlohmann/json.hpp>

#include "core/io/sequence.h"
#include "tests/mapping/sample_recording.h"
#include "tests/tools/coarse_model_file.h"
#include "tools/camloc/commands.h"

namespace camloc::tools {
namespace {

class CoarseCommand : public ::testing::Test {
 protected:
  CoarseCommand() {
    std::string truth;
    for (std::uint64_t i = 0; i < 4; ++i) truth += format_tum_line(testing::SampleWorld::get().frame(i).stamp_ns, sample_pose(i)) + "\n";
    truth_ = recording_.folder.write("truth.tum", truth);
    model_ = recording_.folder / "a.onnx";
    write_constant_model(model_, sample_pose(0));
    use_built_plugin();
  }
  [[nodiscard]] std::vector<std::string> on_recording(std::vector<std::string> first) const {
    for (const std::string& argument : {std::string("--map"), testing::SampleWorld::get().map().info().path, std::string("--sequence"),
                                        recording_.folder.path(), std::string("--camera"), recording_.camera_path})
      first.push_back(argument);
    return first;
  }
  mapping::SampleRecording recording_{4};
  std::string truth_, model_;
};

TEST_F(CoarseCommand, InfoSaysWhatTheModelIsFor) {
  const CommandOutput text = run_command(add_coarse_command, {"coarse", "info", model_});
  EXPECT_EQ(text.exit_code, 0) << text.err;
  EXPECT_NE(text.out.find("kitchen, frames 0 to 99"), std::string::npos) << text.out;
  const CommandOutput output = run_command(add_coarse_command, {"coarse", "info", model_, "--json"});
  const auto json = nlohmann::json::parse(output.out, nullptr, false);
  EXPECT_EQ(json["map_id"], map_id_text(testing::SampleWorld::get().map().info().map_id));
  EXPECT_EQ(json["weights"], 21);
  EXPECT_EQ(json["input"]["width"], 16);
  EXPECT_EQ(json["sigma_position_m"], 0.25);
}

TEST_F(CoarseCommand, EvalComparesNetworkRetrievalAndBoth) {
  if (!kHasPlugin) GTEST_SKIP() << "the plug-in is not built";
  const CommandOutput output = run_command(add_coarse_command, on_recording({"coarse", "eval", model_, "--reference", truth_, "--json"}));
  ASSERT_EQ(output.exit_code, 0) << output.err;
  const auto json = nlohmann::json::parse(output.out, nullptr, false);
  EXPECT_EQ(json["frames"], 4);
  for (const char* who : {"cnn", "retrieval", "both"}) {
    for (const char* what : {"translation_m", "rotation_deg"}) {
      for (const char* how : {"median", "mean", "p90", "max"}) EXPECT_TRUE(json[who][what][how].is_number()) << who << what << how;
    }
  }
  EXPECT_LT(json["cnn"]["translation_m"]["median"], 0.2);
}

TEST_F(CoarseCommand, WhatIsWrongIsOneLine) {
  const auto refused = [&](const std::string& model, const char* why) {
    const CommandOutput output = run_command(add_coarse_command, on_recording({"coarse", "eval", model, "--reference", truth_}));
    EXPECT_NE(output.exit_code, 0);
    EXPECT_NE(output.err.find(why), std::string::npos) << output.err;
    EXPECT_EQ(std::count(output.err.begin(), output.err.end(), '\n'), 1) << output.err;
  };
  write_constant_model(recording_.folder / "other.onnx", sample_pose(0), 5);
  refused(recording_.folder / "other.onnx", "is for map 0000000000000005");
  refused(recording_.folder.write("text.onnx", "no network"), "no ONNX file");
  refused(recording_.folder / "none.onnx", "none.onnx");
  ::setenv("CAMLOC_NETWORK_PLUGIN", "/nowhere.so", 1);
  refused(model_, "package camloc-coarse");
}

TEST_F(CoarseCommand, LocalizeAndWakeupAskIt) {
  if (!kHasPlugin) GTEST_SKIP() << "the plug-in is not built";
  const std::string json_path = recording_.folder / "out.json";
  const CommandOutput localize = run_command(
      add_localize_command, on_recording({"localize", "--coarse", model_, "--out", recording_.folder / "out.tum", "--json", json_path}));
  ASSERT_EQ(localize.exit_code, 0) << localize.err;
  std::ifstream file(json_path);
  const auto json = nlohmann::json::parse(file, nullptr, false);
  EXPECT_EQ(json["frames"][0]["proposed_by"], "retrieval");
  EXPECT_EQ(json["frames"][1]["proposed_by"], "motion");
  const CommandOutput wakeup =
      run_command(add_wakeup_command,
                  on_recording({"wakeup", "--coarse", model_, "--reference", truth_, "--count", "2", "--seconds", "0.05", "--json"}));
  ASSERT_EQ(wakeup.exit_code, 0) << wakeup.err;
  EXPECT_EQ(nlohmann::json::parse(wakeup.out, nullptr, false)["misleading"], 0);
}

}  // namespace
}  // namespace camloc::tools
