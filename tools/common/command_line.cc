// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/common/command_line.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <system_error>

#include "tools/common/text_format.h"

namespace camloc::tools {
namespace {

/// "camloc map info": the program and the sub-commands that were recognised.
std::string chosen_command(const CLI::App& app) {
  std::string name = app.get_name();
  for (const CLI::App* command = &app; !command->get_subcommands().empty();) {
    command = command->get_subcommands().front();
    name += " " + command->get_name();
  }
  return name;
}

}  // namespace

int parse_command_line(CLI::App& app, int argc, const char* const* argv, bool* is_over) {
  *is_over = true;
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    print_error(app.get_name(), std::string(error.what()) + "; see '" + chosen_command(app) + " --help'");
    return 2;
  } catch (const std::exception& error) {  // out of memory, mostly
    print_error(app.get_name(), error.what());
    return 1;
  }
  *is_over = false;
  return 0;
}

void print_error(const std::string& program, const std::string& message) {
  std::fprintf(stderr, "%s: %s\n", program.c_str(), printable(message).c_str());
}

int report(const std::string& program, const Status& status) {
  if (status.is_ok()) return 0;
  print_error(program, status.message());
  return status.code() == ErrorCode::kInvalid ? 2 : 1;
}

bool print_text(const std::string& text) { return std::fputs(text.c_str(), stdout) >= 0 && std::fflush(stdout) == 0; }

Status check_output_path(const std::string& option, const std::string& path) {
  std::error_code ignored;
  if (path.empty()) return {ErrorCode::kInvalid, option + ": is empty; give a file name"};
  if (std::filesystem::is_directory(path, ignored)) return {ErrorCode::kInvalid, option + " " + path + ": is a folder; give a file name"};
  const auto folder = std::filesystem::path(path).parent_path();
  if (folder.empty() || std::filesystem::is_directory(folder, ignored)) return Status::ok();
  return {ErrorCode::kInvalid, option + " " + path + ": folder " + folder.string() + " does not exist; make it first"};
}

}  // namespace camloc::tools
