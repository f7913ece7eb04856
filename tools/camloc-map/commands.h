// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The sub-commands of `camloc-map`. Each function adds one to the command line; when it was chosen, its callback stores the
// exit code: 0 done, 1 failed, 2 usage or configuration.
#pragma once

#include "tools/common/command_line.h"

namespace CLI {
class App;
}

namespace camloc::mapping {

void add_build_command(CLI::App& app, int& exit_code);
void add_eval_command(CLI::App& app, int& exit_code);
void add_export_command(CLI::App& app, int& exit_code);
void add_view_command(CLI::App& app, int& exit_code);
void add_georef_command(CLI::App& app, int& exit_code);
void add_merge_command(CLI::App& app, int& exit_code);
void add_upgrade_command(CLI::App& app, int& exit_code);

/// Prints "camloc-map: <message>" on stderr; the exit code that belongs to the error.
inline int report(const Status& status) { return tools::report("camloc-map", status); }
/// The same with another exit code.
inline int report_error(const Status& status, int exit_code) { return report(status), exit_code; }

}  // namespace camloc::mapping
