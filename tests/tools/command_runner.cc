// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/tools/command_runner.h"

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>

namespace camloc::tools {

CommandOutput run_command(void (*add)(CLI::App&, int&), std::vector<std::string> arguments) {
  CLI::App app;
  CommandOutput output;
  add(app, output.exit_code);
  std::reverse(arguments.begin(), arguments.end());  // the order CLI::App::parse(vector) wants
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  try {
    app.parse(arguments);
  } catch (const CLI::ParseError&) { output.exit_code = 2; }
  std::fflush(stdout);
  output.out = ::testing::internal::GetCapturedStdout();
  output.err = ::testing::internal::GetCapturedStderr();
  return output;
}

}  // namespace camloc::tools
