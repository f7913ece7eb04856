// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// How every program reads its arguments and says that something went wrong: one line on stderr and an exit code,
// 0 done, 1 failed, 2 usage or configuration.
#pragma once

#include <string>

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

/// Whether all of `text` went to stdout.
[[nodiscard]] bool print_text(const std::string& text);

/// Whether a result can be written where the user wants it, asked before the work is done.
/// kInvalid where `path` is empty, a folder, or in a folder that does not exist; `option` is named in the message.
[[nodiscard]] Status check_output_path(const std::string& option, const std::string& path);

}  // namespace camloc::tools
