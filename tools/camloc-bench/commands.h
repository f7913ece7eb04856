// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What `camloc bench` does besides localizing.
#pragma once

namespace CLI {
class App;
}

namespace camloc::bench {

/// Adds `slam`; when it was chosen, its callback stores the exit code.
CLI::App* add_slam_command(CLI::App& app, int& exit_code);

}  // namespace camloc::bench
