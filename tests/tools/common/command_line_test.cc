// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Usage errors, errors and texts: one line each, and the exit code.

#include "tools/common/command_line.h"

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>

#include "tests/tools/command_runner.h"

namespace camloc::tools {
namespace {

struct Parsed {
  int exit_code = 0;
  bool is_over = false;
  std::string err;
};

Parsed parse(std::vector<const char*> arguments) {
  CLI::App app{"test", "camloc"};
  app.require_subcommand(1);
  app.add_subcommand("map")->add_option("--size")->check(CLI::Range(1, 9));
  arguments.insert(arguments.begin(), "camloc");
  Parsed parsed;
  ::testing::internal::CaptureStderr();
  ::testing::internal::CaptureStdout();
  parsed.exit_code = parse_command_line(app, static_cast<int>(arguments.size()), arguments.data(), &parsed.is_over);
  ::testing::internal::GetCapturedStdout();
  parsed.err = ::testing::internal::GetCapturedStderr();
  return parsed;
}

TEST(CommandLineTest, RightArgumentsGoOn) {
  const Parsed parsed = parse({"map", "--size", "5"});
  EXPECT_FALSE(parsed.is_over);
  EXPECT_EQ(parsed.exit_code, 0);
  EXPECT_EQ(parsed.err, "");
}

TEST(CommandLineTest, HelpIsNoErrorAndAMistakeIs) {
  const Parsed help = parse({"--help"});
  EXPECT_TRUE(help.is_over);
  EXPECT_EQ(help.exit_code, 0);
  for (const auto& arguments : {std::vector<const char*>{}, {"map", "--size", "12"}, {"map", "--colour"}, {"fly"}}) {
    const Parsed wrong = parse(arguments);
    EXPECT_TRUE(wrong.is_over);
    EXPECT_EQ(wrong.exit_code, 2);
    EXPECT_EQ(std::count(wrong.err.begin(), wrong.err.end(), '\n'), 1) << wrong.err;
  }
  EXPECT_NE(parse({"map", "--colour"}).err.find("see 'camloc map --help'"), std::string::npos);
}

TEST(CommandLineTest, ErrorsAreOneLineWithTheirExitCode) {
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(report("camloc", Status::ok()), 0);
  EXPECT_EQ(report("camloc", {ErrorCode::kInvalid, "a\nb\x1b[2J"}), 2);
  EXPECT_EQ(report("camloc-map", {ErrorCode::kIo, "disk"}), 1);
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "camloc: a?b?[2J\ncamloc-map: disk\n");
  ::testing::internal::CaptureStdout();
  EXPECT_TRUE(print_text("text\n"));
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "text\n");
}

TEST(OutputPathTest, AFileInAFolderThatIsThere) {
  const TemporaryFolder folder;
  EXPECT_TRUE(check_output_path("--out", folder / "new.cmap").is_ok());
  EXPECT_TRUE(check_output_path("--out", folder.write("old.cmap", "x")).is_ok()) << "an old file may be replaced";
  EXPECT_TRUE(check_output_path("--out", "here.cmap").is_ok());
  for (const std::string& path : {std::string(), folder.path(), folder / "no/such/x", folder / "old.cmap/x"}) {
    const Status status = check_output_path("--out", path);
    EXPECT_EQ(status.code(), ErrorCode::kInvalid) << path;
    EXPECT_NE(status.message().find("--out"), std::string::npos) << status.message();
  }
}

/// The message of kInvalid, or what else it was.
std::string refusal(const Status& status) {
  if (status.is_ok()) return "fine";
  return status.code() == ErrorCode::kInvalid ? status.message() : "another code: " + status.message();
}

TEST(OutputPathTest, NoOutputIsAnInputOrAnotherOutput) {
  const TemporaryFolder folder;
  const std::string map = folder.write("a.cmap", "x"), camera = folder.write("c.toml", "x");
  std::filesystem::create_symlink("a.cmap", folder / "link");
  const std::vector<NamedPath> inputs{{"--map", map}, {"--camera", camera}, {"--reference", ""}, {"--source", "kinect://"}};
  EXPECT_EQ(refusal(check_outputs({{"--out", folder / "new"}, {"--json", folder / "other"}}, inputs)), "fine");
  EXPECT_NE(refusal(check_outputs({{"--out", map}}, inputs)).find("would replace the file of --map"), std::string::npos);
  EXPECT_NE(refusal(check_outputs({{"--out", folder / "link"}}, inputs)).find("would replace the file of --map"), std::string::npos);
  EXPECT_NE(refusal(check_outputs({{"--out", folder / "new"}, {"--json", camera}}, inputs)).find("--json"), std::string::npos);
  EXPECT_NE(
      refusal(check_outputs({{"--out", folder / "new"}, {"--json", folder / "./new"}}, inputs)).find("--out and --json name the same"),
      std::string::npos);
}

TEST(OutputPathTest, WhatARecordingIsMadeOfStays) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "walk/rgb");
  const std::string list = folder.write("walk/rgb.txt", "x"), image = folder.write("walk/rgb/1.png", "x");
  const std::string view = folder.write("walk/frame-000001.color.png", "x"), oni = folder.write("walk.oni", "x");
  const std::string estimate = folder.write("walk/estimate.txt", "x"), picture = folder.write("walk/picture.png", "x");
  for (const std::string& walk : {folder / "walk", "replay://" + (folder / "walk") + "?speed=2"}) {
    for (const std::string& path : {list, image, view})
      EXPECT_NE(refusal(check_outputs({{"--out", path}}, {{"--sequence", walk}})).find("recording of --sequence"), std::string::npos)
          << path;
    for (const std::string& path : {estimate, picture, folder / "walk/new.png"})
      EXPECT_EQ(refusal(check_outputs({{"--out", path}}, {{"--sequence", walk}})), "fine") << path;
  }
  EXPECT_NE(refusal(check_outputs({{"--out", oni}}, {{"--sequence", "oni://" + oni}})), "fine");
}

TEST(OutputPathTest, DevicesAndLinksInASharedFolderAreRefused) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "shared");
  std::filesystem::create_symlink("x", folder / "shared/link");
  std::filesystem::permissions(folder / "shared", std::filesystem::perms(0770));
  EXPECT_NE(refusal(check_output_path("--out", folder / "shared/link")).find("symbolic link"), std::string::npos);
  EXPECT_NE(refusal(check_output_path("--out", "/dev/null")).find("device"), std::string::npos);
}

}  // namespace
}  // namespace camloc::tools
