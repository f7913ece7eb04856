// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// How every program reads its arguments and says that something went wrong: one line on stderr and an exit code,
// 0 done, 1 failed, 2 usage or configuration.
#pragma once

#include <string>
#include <vector>

#include "core/base/result.h"

namespace CLI {
class App;
}

namespace camloc::tools {

/// Parses and runs the callbacks. Returns 0 when the arguments were right, and the exit code otherwise; sets `is_over` when
/// the program has nothing left to do (an error, --help, --version). The hint of an error names the sub-command's help.
[[nodiscard]] int parse_command_line(CLI::App& app, int argc, const char* const* argv, bool* is_over);

/// "program: message" on stderr. Line ends and other control characters, which a file name may hold, become '?'.
void print_error(const std::string& program, const std::string& message);

/// print_error() of the message, where `status` is an error. The exit code that belongs to it: 0, 2 for kInvalid, 1 for the rest.
int report(const std::string& program, const Status& status);

/// Whether all of `text`, of one or more lines, went to stdout. Names in it may come from anywhere: each line is made printable().
[[nodiscard]] bool print_text(const std::string& text);

/// A file of the command line and the option that names it. Recordings may be folders and URLs.
struct NamedPath {
  std::string option, path;
};

/// Whether the results can be written where the user wants them, asked before the work is done: one question for all outputs of a
/// command and all files it reads. Empty paths of options that were not given are left out by the caller.
/// kInvalid where an output is empty, a folder, a device, in a folder that does not exist, a symbolic link in a folder that others may
/// write to (see resolve_output), the same file as an input or as another output, by whatever name, or a file of a recording that is
/// read. The option is named in the message.
[[nodiscard]] Status check_outputs(const std::vector<NamedPath>& outputs, const std::vector<NamedPath>& inputs);
/// The same of one output where no input is at risk.
[[nodiscard]] Status check_output_path(const std::string& option, const std::string& path);

}  // namespace camloc::tools
