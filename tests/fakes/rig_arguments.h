// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The command line that both fake Kinects share: what device, what it shows, which faults, where it is steered and logged.
#pragma once

#include <string>
#include <vector>

#include "tests/fakes/control_server.h"
#include "tests/fakes/kinect_rig.h"

namespace CLI {
class App;
}

namespace camloc::fakes {

struct RigArguments {
  RigOptions rig;
  std::string control_socket;
  std::vector<TimedCommand> schedule;
  std::string counts_file;  ///< gets the counts at the end

  // As given, before finish().
  std::string model = "1414", geometry = "kinect", descriptors = "none", at_end = "loop";
  std::vector<std::string> timed;
  double clock_ppm = 0, video_delay_ms = 4;
};

/// Declares the options; `arguments` outlives the parse.
void add_rig_options(CLI::App* app, RigArguments* arguments);
/// Checks what the parser cannot, and fills `rig` and `schedule`.
[[nodiscard]] Status finish(RigArguments* arguments);
/// For --counts.
[[nodiscard]] Status write_counts(const std::string& path, const std::string& counts);

}  // namespace camloc::fakes
