// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// `camloc COMMAND`: the commands built in below, or the program camloc-COMMAND.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <vector>

#include "core/base/memory_guard.h"
#include "core/map/mapping_guard.h"
#include "tools/camloc/commands.h"
#include "tools/common/command_line.h"
#include "tools/common/program.h"

namespace camloc::tools {
namespace {

constexpr std::array kCommands{&add_localize_command, &add_wakeup_command, &add_eval_command,   &add_coarse_command,
                               &add_epipolar_command, &add_map_command,    &add_camera_command, &add_record_command,
                               &add_monitor_command,  &add_ctl_command,    &add_doctor_command, &add_frames_command};
/// A command of which a part is built in and the rest is in the program camloc-NAME.
struct SplitCommand {
  std::vector<std::string> built_in, in_program;
};
const std::map<std::string, SplitCommand> kSplitCommands{
    {"map", {{"info", "verify"}, {"build", "eval", "export", "georef", "merge", "upgrade", "view"}}},
    {"camera", {{"list", "show", "import"}, {"calibrate"}}},
};
const char* const kProgramsHelp =
    "Programs of other packages, run as `camloc NAME`; camloc-tools:\n"
    "  map build                   Build a map from a recorded walk\n"
    "  map view, map export        See a map; write it for other viewers\n"
    "  map georef, map merge       Put a map into site coordinates; join walks\n"
    "  map upgrade                 Find the look-alikes of a map made without them\n"
    "  map eval                    Compare a map with a laser scan\n"
    "  sim                         Write a synthetic building with its walks\n"
    "camloc-calibration:\n"
    "  camera calibrate            Find a camera's calibration with a flat board\n"
    "camloc-bench:\n"
    "  bench                       Time and accuracy, beside plain OpenCV calls\n"
    "camloc-training:\n"
    "  train                       Teach a network where in a map a camera is";
/// The package that a program camloc-NAME is in.
const std::map<std::string, std::string> kPackages{{"map", "camloc-tools"},
                                                   {"sim", "camloc-tools"},
                                                   {"camera", "camloc-calibration"},
                                                   {"bench", "camloc-bench"},
                                                   {"train", "camloc-training"}};

bool is_one_of(const std::string& word, const std::vector<std::string>& words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

std::vector<std::string> built_in_commands(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

/// Whether `camloc arguments...` is a matter of the program camloc-<arguments[0]>.
bool is_external(const CLI::App& app, const std::vector<std::string>& arguments) {
  if (arguments.empty() || arguments[0].empty() || arguments[0][0] == '-') return false;
  const auto split = kSplitCommands.find(arguments[0]);
  if (split == kSplitCommands.end()) return !is_one_of(arguments[0], built_in_commands(app));
  return arguments.size() > 1 && arguments[1][0] != '-' && !is_one_of(arguments[1], split->second.built_in);
}

/// Names the closest sub-command of a split command.
int report_unknown(const std::string& name, const SplitCommand& split, const std::string& word) {
  std::vector<std::string> known = split.built_in;
  known.insert(known.end(), split.in_program.begin(), split.in_program.end());
  const std::string closest = closest_word(word, known);
  print_error("camloc", "no command '" + name + " " + word + "'; " +
                            (closest.empty() ? "see 'camloc " + name + " --help'" : "did you mean '" + name + " " + closest + "'?"));
  return 2;
}

/// Becomes camloc-X; returns 2 where there is none.
int run_external(const CLI::App& app, const std::vector<std::string>& arguments) {
  const auto split = kSplitCommands.find(arguments[0]);
  if (split != kSplitCommands.end() && arguments.size() > 1 && !is_one_of(arguments[1], split->second.in_program))
    return report_unknown(split->first, split->second, arguments[1]);
  const auto program = find_program("camloc-" + arguments[0]);
  if (program) return report(exec_program(*program, {arguments.begin() + 1, arguments.end()}));

  std::vector<std::string> known = built_in_commands(app);
  known.insert(known.begin(), {"bench", "sim", "train"});
  std::string hint = "see 'camloc --help'";
  if (const auto package = kPackages.find(arguments[0]); package != kPackages.end()) {
    hint = "install the package " + package->second;
  } else if (const std::string closest = closest_word(arguments[0], known); !closest.empty()) {
    hint = "did you mean '" + closest + "'?";
  }
  print_error("camloc", "no command '" + arguments[0] + "' and no program camloc-" + arguments[0] + "; " + hint);
  return 2;
}

}  // namespace
}  // namespace camloc::tools

int main(int argc, char** argv) {
  camloc::install_memory_guard("camloc: out of memory; close other programs or add swap\n");
  camloc::install_mapping_guard();
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  int exit_code = 0;
  CLI::App app("Where is this camera in the building? Tools around camlocd and its maps.", "camloc");
  app.set_version_flag("--version", "camloc " CAMLOC_VERSION);
  app.require_subcommand(1);
  for (const auto add : camloc::tools::kCommands) add(app, exit_code);
  app.footer(camloc::tools::kProgramsHelp);  // after the sub-commands, which would inherit it
  if (camloc::tools::is_external(app, arguments)) return camloc::tools::run_external(app, arguments);

  bool is_over = false;
  const int usage = camloc::tools::parse_command_line(app, argc, argv, &is_over);
  return is_over ? usage : exit_code;
}
