// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// camloc-camera: finds the calibration of a camera. `camloc camera calibrate` runs this program.
#include "tools/camloc-camera/commands.h"
#include "tools/common/command_line.h"

int main(int argc, char** argv) {
  CLI::App app{"Finds the calibration of an RGB-D camera.", "camloc-camera"};
  app.require_subcommand(1);
  int exit_code = 0;
  camloc::camera_tool::add_calibrate_command(app, exit_code);
  bool is_over = false;
  const int usage = camloc::tools::parse_command_line(app, argc, argv, &is_over);
  return is_over ? usage : exit_code;
}
