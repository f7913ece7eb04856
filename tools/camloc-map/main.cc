// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// camloc-map: makes maps, on a workstation. `camloc map build` runs this program.

#include <CLI/CLI.hpp>

#include "core/base/memory_guard.h"
#include "core/map/mapping_guard.h"
#include "tools/camloc-map/commands.h"

int main(int argc, char** argv) {
  camloc::install_mapping_guard();
  camloc::install_memory_guard(
      "camloc-map: out of memory; close other programs or add swap, or map fewer frames at a time (--frames, then --extend). No map was "
      "written; an "
      "interrupted build goes on with --resume\n");
  CLI::App app{"Makes maps for camloc from recorded RGB-D sequences.", "camloc-map"};
  app.require_subcommand(1);
  int exit_code = 0;
  camloc::mapping::add_build_command(app, exit_code);
  camloc::mapping::add_eval_command(app, exit_code);
  camloc::mapping::add_export_command(app, exit_code);
  camloc::mapping::add_view_command(app, exit_code);
  camloc::mapping::add_georef_command(app, exit_code);
  camloc::mapping::add_merge_command(app, exit_code);
  camloc::mapping::add_upgrade_command(app, exit_code);
  bool is_over = false;
  const int usage = camloc::tools::parse_command_line(app, argc, argv, &is_over);
  return is_over ? usage : exit_code;
}
