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

}  // namespace
}  // namespace camloc::tools
