// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// `camloc COMMAND`: the commands built in below, or the program camloc-COMMAND.
#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "core/map/mapping_guard.h"
#include "tools/camloc/commands.h"
#include "tools/camloc/program.h"
#include "tools/common/command_line.h"

namespace {

using camloc::tools::exec_program;
using camloc::tools::find_program;

struct Command {
  const char* name;
  void (*add)(CLI::App& app, int& exit_code);
};

constexpr std::array kCommands{
    Command{"localize", camloc::tools::add_localize_command},
    Command{"eval", camloc::tools::add_eval_command},
    Command{"map", camloc::tools::add_map_command},
    Command{"record", camloc::tools::add_record_command},
    Command{"monitor", camloc::tools::add_monitor_command},
    Command{"ctl", camloc::tools::add_ctl_command},
    Command{"doctor", camloc::tools::add_doctor_command},
    Command{"frames", camloc::tools::add_frames_command},
};
/// Sub-commands of `camloc map` that are built in, and those of the program camloc-map.
const std::vector<std::string> kMapCommands{"info", "verify"};
const std::vector<std::string> kMapProgramCommands{"build", "eval", "export", "georef", "merge", "view"};
const char* const kProgramsHelp =
    "Programs of the package camloc-tools, run as `camloc NAME`:\n"
    "  map build                   Build a map from a recorded walk\n"
    "  map view, map export        See a map; write it for other viewers\n"
    "  map georef, map merge       Put a map into site coordinates; join walks\n"
    "  map eval                    Compare a map with a laser scan\n"
    "  bench                       Time and accuracy, beside plain OpenCV calls\n"
    "  sim                         Write a synthetic building with its walks";

bool is_one_of(const std::string& word, const std::vector<std::string>& words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

bool is_built_in(const CLI::App& app, const std::string& name) {
  for (const CLI::App* command : app.get_subcommands({})) {
    if (command->get_name() == name) return true;
  }
  return false;
}

/// Whether `camloc arguments...` is a matter of the program camloc-<arguments[0]>.
bool is_external(const CLI::App& app, const std::vector<std::string>& arguments) {
  if (arguments.empty() || arguments[0].empty() || arguments[0][0] == '-') return false;
  if (arguments[0] != "map") return !is_built_in(app, arguments[0]);
  if (!is_built_in(app, "map")) return true;
  return arguments.size() > 1 && arguments[1][0] != '-' && !is_one_of(arguments[1], kMapCommands);
}

/// Becomes camloc-X; returns 2 where there is none.
int run_external(const CLI::App& app, const std::vector<std::string>& arguments) {
  const auto program = find_program("camloc-" + arguments[0]);
  if (arguments[0] == "map" && arguments.size() > 1 && !is_one_of(arguments[1], kMapProgramCommands)) {
    std::vector<std::string> known = kMapCommands;
    known.insert(known.end(), kMapProgramCommands.begin(), kMapProgramCommands.end());
    const std::string closest = camloc::tools::closest_word(arguments[1], known);
    camloc::tools::print_error("camloc", "no command 'map " + arguments[1] + "'; " +
                                             (closest.empty() ? "see 'camloc map --help'" : "did you mean 'map " + closest + "'?"));
    return 2;
  }
  if (program) return camloc::tools::report(exec_program(*program, {arguments.begin() + 1, arguments.end()}));

  std::vector<std::string> known{"map", "sim"};
  for (const CLI::App* command : app.get_subcommands({})) known.push_back(command->get_name());
  std::string hint = "see 'camloc --help'";
  if (arguments[0] == "map" || arguments[0] == "sim") {
    hint = "install the package camloc-tools";
  } else if (const std::string closest = camloc::tools::closest_word(arguments[0], known); !closest.empty()) {
    hint = "did you mean '" + closest + "'?";
  }
  camloc::tools::print_error("camloc", "no command '" + arguments[0] + "' and no program camloc-" + arguments[0] + "; " + hint);
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  camloc::install_mapping_guard();
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  int exit_code = 0;
  CLI::App app("Where is this camera in the building? Tools around camlocd and its maps.", "camloc");
  app.set_version_flag("--version", "camloc " CAMLOC_VERSION);
  app.require_subcommand(1);
  for (const auto& command : kCommands) command.add(app, exit_code);
  app.footer(kProgramsHelp);  // after the sub-commands, which would inherit it
  if (is_external(app, arguments)) return run_external(app, arguments);

  bool is_over = false;
  const int usage = camloc::tools::parse_command_line(app, argc, argv, &is_over);
  return is_over ? usage : exit_code;
}
