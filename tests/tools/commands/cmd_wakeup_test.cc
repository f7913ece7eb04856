// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// `camloc wakeup`: cold starts over a recording of the sample room are judged by its true poses.
#include <nlohmann/json.hpp>

#include "core/io/sequence.h"
#include "tests/mapping/sample_recording.h"
#include "tools/camloc/commands.h"

namespace camloc::tools {
namespace {

class WakeupCommand : public ::testing::Test {
 protected:
  WakeupCommand() {
    const testing::SampleWorld& world = testing::SampleWorld::get();
    std::string truth, elsewhere;
    for (std::uint64_t i = 0; i < 8; ++i) {
      Rigid3 pose = sample_pose(i);
      truth += format_tum_line(world.frame(i).stamp_ns, pose) + "\n";
      pose.translation.x() += 3;
      elsewhere += format_tum_line(world.frame(i).stamp_ns, pose) + "\n";
    }
    truth_ = recording_.folder.write("truth.tum", truth);
    elsewhere_ = recording_.folder.write("elsewhere.tum", elsewhere);
  }
  [[nodiscard]] CommandOutput wakeup(std::vector<std::string> further) const {
    std::vector<std::string> arguments = {"wakeup",
                                          "--map",
                                          testing::SampleWorld::get().map().info().path,
                                          "--sequence",
                                          recording_.folder.path(),
                                          "--camera",
                                          recording_.camera_path};
    arguments.insert(arguments.end(), further.begin(), further.end());
    return run_command(add_wakeup_command, arguments);
  }
  mapping::SampleRecording recording_{8};
  std::string truth_, elsewhere_;
};

TEST_F(WakeupCommand, EveryStartFindsItselfInTheSampleRoom) {
  const std::string png = recording_.folder / "out.png";
  const CommandOutput output = wakeup({"--reference", truth_, "--count", "4", "--seconds", "0.05", "--json", "--png", png});
  ASSERT_EQ(output.exit_code, 0) << output.err;
  const auto json = nlohmann::json::parse(output.out, nullptr, false);
  EXPECT_EQ(json["starts"], 4);
  EXPECT_EQ(json["fixed"], 4);
  EXPECT_EQ(json["misleading"], 0);
  EXPECT_EQ(json["wrong_first_fixes"], 0);
  ASSERT_EQ(json["wakeups"].size(), 4U);
  EXPECT_EQ(json["wakeups"][1]["first_frame"], 2);
  EXPECT_TRUE(json["wakeups"][0]["complete"]);
  EXPECT_LT(json["wakeups"][0]["first_fix_error_m"], 0.05);
  EXPECT_TRUE(std::filesystem::exists(png));
}

TEST_F(WakeupCommand, APoseElsewhereMisleads) {
  const CommandOutput output = wakeup({"--reference", elsewhere_, "--count", "2", "--seconds", "0.1"});
  ASSERT_EQ(output.exit_code, 0) << output.err;
  EXPECT_NE(output.out.find("first fix     wrong 2"), std::string::npos) << output.out;
}

TEST_F(WakeupCommand, WhatCannotBeJudgedIsRefused) {
  EXPECT_EQ(wakeup({}).exit_code, 1) << "the recording has no poses";
  EXPECT_EQ(wakeup({"--reference", recording_.folder / "none.tum"}).exit_code, 1);
  const std::string other = recording_.folder.write("other.tum", "1 0 0 0 0 0 0 1\n");
  const CommandOutput output = wakeup({"--reference", other});
  EXPECT_EQ(output.exit_code, 2);
  EXPECT_NE(output.err.find("has no pose at the times"), std::string::npos) << output.err;
  EXPECT_EQ(wakeup({"--reference", truth_, "--count", "0"}).exit_code, 2);
  EXPECT_EQ(wakeup({"--reference", truth_, "--seconds", "-1"}).exit_code, 2);
  EXPECT_EQ(wakeup({"--reference", truth_, "--png", recording_.folder / "no/x.png"}).exit_code, 2);
}

}  // namespace
}  // namespace camloc::tools
