// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The sub-commands of `camloc`. Each function adds one to the command line; when it was chosen, its callback stores the
// exit code: 0 done, 1 failed, 2 usage or configuration.
#pragma once

#include "tools/common/command_line.h"

namespace CLI {
class App;
}

namespace camloc::tools {

void add_localize_command(CLI::App& app, int& exit_code);
void add_wakeup_command(CLI::App& app, int& exit_code);
void add_eval_command(CLI::App& app, int& exit_code);
void add_coarse_command(CLI::App& app, int& exit_code);  ///< info and eval; train is the program camloc-train
void add_epipolar_command(CLI::App& app, int& exit_code);
void add_map_command(CLI::App& app, int& exit_code);  ///< info and verify; build is the program camloc-map
void add_monitor_command(CLI::App& app, int& exit_code);
void add_ctl_command(CLI::App& app, int& exit_code);
void add_doctor_command(CLI::App& app, int& exit_code);
void add_frames_command(CLI::App& app, int& exit_code);
void add_camera_command(CLI::App& app, int& exit_code);  ///< list, show, import; calibrate is the program camloc-camera
void add_record_command(CLI::App& app, int& exit_code);

/// Prints "camloc: <message>" on stderr; the exit code that belongs to the error.
inline int report(const Status& status) { return report("camloc", status); }

}  // namespace camloc::tools
