// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// `camloc COMMAND`: the commands built in below, or the program camloc-COMMAND.
#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <vector>

#include "core/map/mapping_guard.h"
#include "tools/camloc/commands.h"
#include "tools/common/command_line.h"
#include "tools/common/program.h"

namespace {

using camloc::tools::exec_program;
using camloc::tools::find_program;

struct Command {
  const char* name;
  void (*add)(CLI::App& app, int& exit_code);
};

constexpr std::array kCommands{
    Command{"localize", camloc::tools::add_localize_command}, Command{"wakeup", camloc::tools::add_wakeup_command},
    Command{"eval", camloc::tools::add_eval_command},         Command{"epipolar", camloc::tools::add_epipolar_command},
    Command{"map", camloc::tools::add_map_command},           Command{"camera", camloc::tools::add_camera_command},
    Command{"record", camloc::tools::add_record_command},     Command{"monitor", camloc::tools::add_monitor_command},
    Command{"ctl", camloc::tools::add_ctl_command},           Command{"doctor", camloc::tools::add_doctor_command},
    Command{"frames", camloc::tools::add_frames_command},
};
/// Commands of which a part is built in and the rest is in the program camloc-NAME.
struct SplitCommand {
  const char* name;
  std::vector<std::string> built_in, in_program;
};
const std::vector<SplitCommand> kSplitCommands{
    {"map", {"info", "verify"}, {"build", "eval", "export", "georef", "merge", "view"}},
    {"camera", {"list", "show", "import"}, {"calibrate"}},
};
const char* const kProgramsHelp =
    "Programs of other packages, run as `camloc NAME`; camloc-tools:\n"
    "  map build                   Build a map from a recorded walk\n"
    "  map view, map export        See a map; write it for other viewers\n"
    "  map georef, map merge       Put a map into site coordinates; join walks\n"
    "  map eval                    Compare a map with a laser scan\n"
    "  sim                         Write a synthetic building with its walks\n"
    "camloc-calibration:\n"
    "  camera calibrate            Find a camera's calibration with a flat board\n"
    "camloc-bench:\n"
    "  bench                       Time and accuracy, beside plain OpenCV calls";
/// The package that a program camloc-NAME is in.
const std::map<std::string, std::string> kPackages{
    {"map", "camloc-tools"}, {"sim", "camloc-tools"}, {"camera", "camloc-calibration"}, {"bench", "camloc-bench"}};

bool is_one_of(const std::string& word, const std::vector<std::string>& words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

bool is_built_in(const CLI::App& app, const std::string& name) {
  for (const CLI::App* command : app.get_subcommands({})) {
    if (command->get_name() == name) return true;
  }
  return false;
}

const SplitCommand* find_split(const std::string& name) {
  const auto found =
      std::find_if(kSplitCommands.begin(), kSplitCommands.end(), [&name](const SplitCommand& split) { return name == split.name; });
  return found == kSplitCommands.end() ? nullptr : &*found;
}

/// Whether `camloc arguments...` is a matter of the program camloc-<arguments[0]>.
bool is_external(const CLI::App& app, const std::vector<std::string>& arguments) {
  if (arguments.empty() || arguments[0].empty() || arguments[0][0] == '-') return false;
  const SplitCommand* split = find_split(arguments[0]);
  if (split == nullptr) return !is_built_in(app, arguments[0]);
  return arguments.size() > 1 && arguments[1][0] != '-' && !is_one_of(arguments[1], split->built_in);
}

/// Names the closest sub-command of a split command.
int report_unknown(const SplitCommand& split, const std::string& word) {
  std::vector<std::string> known = split.built_in;
  known.insert(known.end(), split.in_program.begin(), split.in_program.end());
  const std::string name = split.name, closest = camloc::tools::closest_word(word, known);
  camloc::tools::print_error("camloc",
                             "no command '" + name + " " + word + "'; " +
                                 (closest.empty() ? "see 'camloc " + name + " --help'" : "did you mean '" + name + " " + closest + "'?"));
  return 2;
}

/// Becomes camloc-X; returns 2 where there is none.
int run_external(const CLI::App& app, const std::vector<std::string>& arguments) {
  const SplitCommand* split = find_split(arguments[0]);
  if (split != nullptr && arguments.size() > 1 && !is_one_of(arguments[1], split->in_program)) return report_unknown(*split, arguments[1]);
  const auto program = find_program("camloc-" + arguments[0]);
  if (program) return camloc::tools::report(exec_program(*program, {arguments.begin() + 1, arguments.end()}));

  std::vector<std::string> known{"bench", "sim"};
  for (const CLI::App* command : app.get_subcommands({})) known.push_back(command->get_name());
  std::string hint = "see 'camloc --help'";
  if (const auto package = kPackages.find(arguments[0]); package != kPackages.end()) {
    hint = "install the package " + package->second;
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
