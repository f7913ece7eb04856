// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The sub-commands of `camloc-camera`. Each function adds one to the command line; when it was chosen, its callback stores the
// exit code: 0 done, 1 failed, 2 usage or configuration.
#pragma once

#include <CLI/CLI.hpp>

namespace camloc::camera_tool {

void add_calibrate_command(CLI::App& app, int& exit_code);

}  // namespace camloc::camera_tool
