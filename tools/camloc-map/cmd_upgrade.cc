// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// `camloc map upgrade`: what newer versions know about a map, for a map that is there.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "tools/camloc-map/commands.h"
#include "tools/common/command_line.h"
#include "tools/common/terminal_observer.h"
#include "tools/mapping/build/map_upgrade.h"

namespace camloc::mapping {
namespace {

struct UpgradeArguments {
  std::string map_path, out_path;
};

Status upgrade(const UpgradeArguments& arguments) {
  const std::string& out_path = arguments.out_path.empty() ? arguments.map_path : arguments.out_path;
  if (Status status = tools::check_output_path("--out", out_path); !status) return status;
  MapUpgradeSummary summary;
  {
    tools::TerminalObserver observer;
    if (Status status = upgrade_map(arguments.map_path, out_path, observer, &summary); !status) return status;
  }
  std::printf("%s: %u of %u keyframes have look-alikes elsewhere, %u of %u landmarks have twins\n", out_path.c_str(),
              summary.num_with_rivals, summary.num_keyframes, summary.num_with_twins, summary.num_landmarks);
  return Status::ok();
}

}  // namespace

void add_upgrade_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<UpgradeArguments>();
  CLI::App* command = app.add_subcommand("upgrade", "Find the look-alikes of a map that was made without them");
  command->add_option("map", arguments->map_path, "Map (.cmap)")->required();
  command->add_option("--out", arguments->out_path, "Map to write (default: the same file, replaced when the new one is whole)");
  command->footer(
      "Needs no recording. Maps that `camloc map build` and `map merge` write have it already.\n"
      "Example: camloc map upgrade building.cmap\n"
      "Exit code: 0 done, 1 failed or interrupted (the map is as it was), 2 wrong usage.");
  command->callback([arguments, &exit_code] { exit_code = report(upgrade(*arguments)); });
}

}  // namespace camloc::mapping
