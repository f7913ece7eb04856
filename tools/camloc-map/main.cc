// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// camloc-map: makes maps, on a workstation. `camloc map build` runs this program.
#include <cstdio>
#include <exception>

#include "tools/camloc-map/commands.h"

namespace camloc::map_tool {

int report_error(const Status& status, int exit_code) {
  std::fprintf(stderr, "camloc-map: %s\n", status.message().c_str());
  return exit_code;
}

}  // namespace camloc::map_tool

int main(int argc, char** argv) {
  CLI::App app{"Makes maps for camloc from recorded RGB-D sequences.", "camloc-map"};
  app.require_subcommand(1);
  int exit_code = 0;
  camloc::map_tool::add_build_command(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const std::exception& error) {  // out of memory, mostly
    std::fprintf(stderr, "camloc-map: %s\n", error.what());
    return 1;
  }
  return exit_code;
}
