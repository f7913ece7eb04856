// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/common/command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <system_error>

#include "core/io/file_bytes.h"
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

Status check_one_output(const NamedPath& output) {
  const auto& [option, path] = output;
  std::error_code ignored;
  if (path.empty()) return {ErrorCode::kInvalid, option + ": is empty; give a file name"};
  if (std::filesystem::is_directory(path, ignored)) return {ErrorCode::kInvalid, option + " " + path + ": is a folder; give a file name"};
  const auto folder = std::filesystem::path(path).parent_path();
  if (!folder.empty() && !std::filesystem::is_directory(folder, ignored))
    return {ErrorCode::kInvalid, option + " " + path + ": folder " + folder.string() + " does not exist; make it first"};
  const Result<std::string> target = resolve_output(path);
  return target ? Status::ok() : Status(ErrorCode::kInvalid, option + ": " + target.status().message());
}

/// "replay:///walk?speed=2" is /walk; empty for what is no file ("kinect://").
std::string path_of_url(const std::string& text) {
  const std::size_t scheme = text.find("://");
  if (scheme == std::string::npos) return text;
  return text.substr(scheme + 3, text.find('?', scheme) - scheme - 3);
}

/// An existing file anywhere below the folder `recording` that is named as recordings name theirs. Results of others may be there.
bool is_recorded_file(const std::string& output, const std::string& recording) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (!fs::is_directory(recording, error) || !fs::exists(output, error)) return false;
  const fs::path file = fs::canonical(output, error), folder = fs::canonical(recording, error);
  if (std::mismatch(folder.begin(), folder.end(), file.begin(), file.end()).first != folder.end()) return false;
  const std::string name = file.filename().string(), extension = file.extension().string();
  constexpr std::array<const char*, 5> kNames = {"rgb.txt", "depth.txt", "groundtruth.txt", "accelerometer.txt", "camera.toml"};
  const bool is_image = extension == ".png" || extension == ".jpg" || extension == ".jpeg";
  return std::find(kNames.begin(), kNames.end(), name) != kNames.end() || name.ends_with(".pose.txt") ||
         (is_image && (file.parent_path() != folder || name.starts_with("frame-")));
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

bool print_text(const std::string& text) {
  std::string shown;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    shown += printable(text.substr(begin, end - begin));
    if (end < text.size()) shown += '\n';
    begin = end + 1;
  }
  return std::fputs(shown.c_str(), stdout) >= 0 && std::fflush(stdout) == 0;
}

Status check_output_path(const std::string& option, const std::string& path) { return check_outputs({{option, path}}, {}); }

Status check_outputs(const std::vector<NamedPath>& outputs, const std::vector<NamedPath>& inputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const NamedPath& output = outputs[i];
    if (Status status = check_one_output(output); !status) return status;
    for (std::size_t other = 0; other < i; ++other) {
      if (is_same_file(output.path, outputs[other].path))
        return {ErrorCode::kInvalid, outputs[other].option + " and " + output.option + " name the same file, " + output.path};
    }
    for (const NamedPath& input : inputs) {
      const std::string path = path_of_url(input.path);
      if (path.empty()) continue;
      if (is_same_file(output.path, path))
        return {ErrorCode::kInvalid, output.option + " " + output.path + ": would replace the file of " + input.option};
      if (is_recorded_file(output.path, path))
        return {ErrorCode::kInvalid, output.option + " " + output.path + ": is a part of the recording of " + input.option};
    }
  }
  return Status::ok();
}

}  // namespace camloc::tools
