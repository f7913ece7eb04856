// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Running other programs, and `camloc` itself as one.
#include "tools/common/program.h"

#include <cstdlib>

#include "tests/tools/command_runner.h"

namespace camloc::tools {
namespace {

using std::chrono::milliseconds;

ProgramOutput shell(const std::string& script) {
  const auto output = run_program("/bin/sh", {"-c", script}, milliseconds(20000));
  EXPECT_TRUE(output.is_ok()) << output.status().message();
  return output ? *output : ProgramOutput{};
}

TEST(ProgramTest, KeepsBothStreamsAndTheExitCode) {
  const ProgramOutput output = shell("echo out; echo err >&2; exit 7");
  EXPECT_EQ(output.out, "out\n");
  EXPECT_EQ(output.err, "err\n");
  EXPECT_EQ(output.exit_code, 7);
}

TEST(ProgramTest, ReadsMoreThanAPipeHolds) {
  EXPECT_EQ(shell("head -c 300000 /dev/zero; head -c 300000 /dev/zero >&2").out.size(), 300000U);
}

TEST(ProgramTest, ASignalIsAnExitCode) { EXPECT_EQ(shell("kill -9 $$").exit_code, 137); }

TEST(ProgramTest, IsKilledWhenTheTimeIsUp) {
  const auto output = run_program("/bin/sh", {"-c", "exec sleep 1000"}, milliseconds(50));
  ASSERT_FALSE(output.is_ok());
  EXPECT_EQ(output.status().code(), ErrorCode::kTimeout);
}

TEST(ProgramTest, IsFoundInPathOrNotAtAll) {
  EXPECT_TRUE(find_program("sh").is_ok());
  const auto program = find_program("camloc-no-such-program");
  ASSERT_FALSE(program.is_ok());
  EXPECT_EQ(program.status().code(), ErrorCode::kNotFound);
}

TEST(ProgramTest, ClosestWord) {
  EXPECT_EQ(closest_word("monitr", {"monitor", "map", "ctl"}), "monitor");
  EXPECT_EQ(closest_word("evla", {"eval", "map", "ctl"}), "eval");
  EXPECT_EQ(closest_word("xyzzyx", {"eval", "map", "ctl"}), "");
}

/// The program itself, with camloc-* programs of our own in PATH.
class CamlocProgramTest : public ::testing::Test {
 protected:
  [[nodiscard]] ProgramOutput camloc(const std::string& arguments) const {
    return shell("PATH=" + folder_.path() + ":$PATH; export PATH; exec " CAMLOC_PROGRAM " " + arguments);
  }
  TemporaryFolder folder_;
};

TEST_F(CamlocProgramTest, RunsAnotherProgramWithItsArgumentsAndExitCode) {
  (void)folder_.write("camloc-zoom", "#!/bin/sh\nprintf '%s|' \"$@\"\nexit 5\n", true);
  const ProgramOutput output = camloc("zoom 'a b' --version ''");
  EXPECT_EQ(output.out, "a b|--version||");
  EXPECT_EQ(output.exit_code, 5);
}

TEST_F(CamlocProgramTest, UnknownCommandsGetASuggestion) {
  const ProgramOutput output = camloc("docter");
  EXPECT_EQ(output.exit_code, 2);
  EXPECT_EQ(output.err, "camloc: no command 'docter' and no program camloc-docter; did you mean 'doctor'?\n");
  EXPECT_EQ(output.out, "");
}

TEST_F(CamlocProgramTest, VersionHelpAndUsage) {
  EXPECT_EQ(camloc("--version").out, "camloc " CAMLOC_VERSION "\n");
  EXPECT_EQ(camloc("--help").exit_code, 0);
  EXPECT_NE(camloc("--help").out.find("doctor"), std::string::npos);
  EXPECT_EQ(camloc("").exit_code, 2);
  EXPECT_EQ(camloc("--no-such-option").exit_code, 2);
  const ProgramOutput output = camloc("monitor --no-such-option");
  EXPECT_EQ(output.exit_code, 2);
  EXPECT_EQ(std::count(output.err.begin(), output.err.end(), '\n'), 1) << output.err;
  EXPECT_NE(output.err.find("camloc monitor --help"), std::string::npos) << output.err;
}

}  // namespace
}  // namespace camloc::tools
