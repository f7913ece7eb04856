// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// `camloc-map build` as a command: arguments that go together, and what is printed.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/io/camera_file.h"
#include "core/io/sequence.h"
#include "core/map/map_view.h"
#include "tests/drivers/test_folder.h"
#include "tests/mapping/recorded_room.h"
#include "tests/tools/command_runner.h"
#include "tools/camloc-map/commands.h"

namespace camloc::mapping {
namespace {

using tools::CommandOutput;

class BuildCommand : public ::testing::Test {
 protected:
  BuildCommand() {
    record_room(folder_ / "walk", 8);
    camera_ = folder_.write("camera.toml", format_camera_toml(room_camera()));
    std::string text;
    for (std::uint64_t i = 0; i < 8; ++i)
      text += format_tum_line(100'000'000'000 + static_cast<std::int64_t>(1e9 * static_cast<double>(i) / 15), room_pose(i)) + "\n";
    poses_ = folder_.write("poses.tum", text);
  }
  [[nodiscard]] CommandOutput build(std::vector<std::string> further) const {
    std::vector<std::string> arguments = {"build", "--sequence", folder_ / "walk", "--camera", camera_, "--out", folder_ / "m.cmap"};
    arguments.insert(arguments.end(), further.begin(), further.end());
    return tools::run_command(add_build_command, arguments);
  }
  TestFolder folder_;
  std::string camera_, poses_;
};

TEST_F(BuildCommand, GivenPosesBecomeAMapAndATable) {
  const CommandOutput output = build({"--poses", poses_, "--name", "my room", "--frames", "1:", "--json"});
  ASSERT_EQ(output.exit_code, 0) << output.err;
  const auto json = nlohmann::json::parse(output.out, nullptr, false);
  EXPECT_EQ(json["frames"]["used"], 7);
  const auto map = MapView::open(folder_ / "m.cmap");
  ASSERT_TRUE(map.is_ok());
  EXPECT_EQ(map->info().name, "my room");
  EXPECT_EQ(json["landmarks"]["kept"], map->info().num_landmarks);
  EXPECT_TRUE(output.err.empty()) << output.err;
}

TEST_F(BuildCommand, BrokenFramesAreNamed) {
  folder_.write("walk/rgb/1003.png", "broken");
  const CommandOutput output = build({"--poses", poses_});
  EXPECT_EQ(output.exit_code, 0) << output.err;
  EXPECT_NE(output.err.find("1 of 8 frames left out because they could not be read"), std::string::npos) << output.err;
}

TEST_F(BuildCommand, WhatDoesNotGoTogetherIsAUsageError) {
  const std::string points = folder_.write("p.csv", "A 1 2 3\n"), seen = folder_.write("s.txt", "A pixel 1 2 3\n");
  const struct {
    std::vector<std::string> arguments;
    const char* part;
  } cases[] = {
      {{"--poses", poses_, "--resume"}, "--resume: goes with a build without --poses"},
      {{"--resume"}, "there is no interrupted build"},
      {{"--poses", poses_, "--trajectory", folder_ / "t.tum"}, "--trajectory: with --poses"},
      {{"--trajectory", folder_ / "no/t.tum"}, "--trajectory"},
      {{"--poses", poses_, "--points", points, "--observed", seen}, "--points: goes with a build without --poses"},
      {{"--poses", poses_, "--extend", folder_ / "none.cmap"}, "--extend"},
      {{"--poses", folder_ / "none.tum"}, "none.tum"},
      {{"--poses", poses_, "--frames", "100:"}, "--frames"},
  };
  for (const auto& c : cases) {
    const CommandOutput output = build(c.arguments);
    EXPECT_NE(output.exit_code, 0) << c.part;
    EXPECT_NE(output.err.find(c.part), std::string::npos) << output.err;
    EXPECT_EQ(std::count(output.err.begin(), output.err.end(), '\n'), 1) << output.err;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "m.cmap"));
  }
}

}  // namespace
}  // namespace camloc::mapping
