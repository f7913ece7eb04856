// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// `camloc localize`: a recording of the sample room against its map becomes a trajectory and records of every frame.
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/mapping/sample_recording.h"
#include "tools/camloc/commands.h"
#include "tools/common/trajectory_file.h"

namespace camloc::tools {
namespace {

class LocalizeCommand : public ::testing::Test {
 protected:
  [[nodiscard]] CommandOutput localize(std::vector<std::string> further) const {
    std::vector<std::string> arguments = {"localize",
                                          "--map",
                                          testing::SampleWorld::get().map().info().path,
                                          "--sequence",
                                          recording_.folder.path(),
                                          "--camera",
                                          recording_.camera_path,
                                          "--out",
                                          out_};
    arguments.insert(arguments.end(), further.begin(), further.end());
    return run_command(add_localize_command, arguments);
  }
  mapping::SampleRecording recording_{8};
  std::string out_ = recording_.folder / "out.tum";
};

TEST_F(LocalizeCommand, WritesTheTrajectoryAndARecordOfEachFrame) {
  const std::string json_path = recording_.folder / "out.json";
  const CommandOutput output = localize({"--json", json_path, "--frames", "0:6"});
  ASSERT_EQ(output.exit_code, 0) << output.err;
  EXPECT_NE(output.out.find("frames      6\n"), std::string::npos) << output.out;
  const auto trajectory = read_trajectory(out_);
  ASSERT_TRUE(trajectory.is_ok()) << trajectory.status().message();
  EXPECT_EQ(trajectory->num_frames, 6U);
  ASSERT_GE(trajectory->poses.size(), 4U);
  std::ifstream file(json_path);
  const auto json = nlohmann::json::parse(file, nullptr, false);
  std::size_t num_localized = 0;
  ASSERT_EQ(json["frames"].size(), 6U) << json.dump().substr(0, 200);
  for (const auto& record : json["frames"]) {
    num_localized += record["state"] == "LOCALIZED" ? 1 : 0;
    if (record["pose"].is_null()) continue;
    EXPECT_EQ(record["pose"]["position_m"].size(), 3U);
    EXPECT_EQ(record["pose"]["orientation_wxyz"].size(), 4U);
    ASSERT_EQ(record["covariance"].size(), 6U);
    EXPECT_EQ(record["covariance"][1][4], record["covariance"][4][1]);
  }
  EXPECT_EQ(num_localized, trajectory->poses.size());
}

TEST_F(LocalizeCommand, UsageErrorsWriteNothing) {
  EXPECT_EQ(localize({"--mode", "sideways"}).exit_code, 2);
  EXPECT_EQ(localize({"--json", recording_.folder / "no/x.json"}).exit_code, 2);
  EXPECT_EQ(localize({"--frames", "many"}).exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(out_));
}

}  // namespace
}  // namespace camloc::tools
