// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// camloc-map view: a picture of a map, and where in it a fix is to be expected.
#include <CLI/CLI.hpp>
#include <map>
#include <memory>

#include "core/io/image_writer.h"
#include "core/io/sequence.h"
#include "tools/camloc-map/commands.h"
#include "tools/common/command_line.h"
#include "tools/common/named_choice.h"
#include "tools/mapping/picture/map_picture.h"

namespace camloc::mapping {
namespace {

constexpr std::size_t kMaxWeakPlaces = 5;  // of each kind
constexpr const char* kFooter =
    "The table says for which share of the keyframes a fix is likely, which look like another place, and where to scan again,\n"
    "with the positions of the worst. A keyframe is judged by its own landmarks; places that no keyframe saw are not judged.\n"
    "Example: camloc map view kitchen.cmap --png kitchen.png\n"
    "Exit code: 0 done, 1 failed, 2 wrong usage or configuration.";

struct ViewArguments {
  std::string map_path, png_path, trajectory_path;
  int width_px = 1600;
  MapPanel panel = MapPanel::kAll;
};

Status show(const MapView& map, const ViewArguments& arguments) {
  MapPicture picture{&map, assess_localizability(map), {}, {}};
  picture.weak = find_weak_places(map, picture.places, kMaxWeakPlaces);
  if (!arguments.trajectory_path.empty()) {
    const auto trajectory = read_tum_trajectory(arguments.trajectory_path);
    if (!trajectory.is_ok()) return trajectory.status();
    for (const StampedPose& pose : trajectory.value()) picture.trajectory.push_back(pose.T_world_camera);
  }
  const ColorImage image = draw_map(picture, arguments.panel, arguments.width_px);
  if (const Status written = write_png(arguments.png_path, image); !written.is_ok()) return written;
  return tools::print_text(format_places(map, picture.places, picture.weak)) ? Status::ok()
                                                                             : Status(ErrorCode::kIo, "cannot write to standard output");
}

int run(const ViewArguments& arguments) {
  const std::vector<tools::NamedPath> inputs{{"the map", arguments.map_path}, {"--trajectory", arguments.trajectory_path}};
  if (const Status output = tools::check_outputs({{"--png", arguments.png_path}}, inputs); !output.is_ok()) return report_error(output, 2);
  const auto map = MapView::open(arguments.map_path);
  if (!map.is_ok()) return report_error(map.status(), 1);
  const Status shown = show(map.value(), arguments);
  return shown.is_ok() ? 0 : report_error(shown, 1);
}

}  // namespace

void add_view_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<ViewArguments>();
  CLI::App* command = app.add_subcommand("view", "Draws a map, and says where in it a fix is to be expected.");
  command->footer(kFooter);
  command->add_option("MAP", arguments->map_path, "Map file (.cmap)")->required();
  command->add_option("--png", arguments->png_path, "Picture to write")->required();
  command->add_option("--trajectory", arguments->trajectory_path,
                      "TrackedRecording to draw into it: TUM trajectory in coordinates of the map");
  command->add_option("--width", arguments->width_px, "Width of the picture in pixels (default 1600)")->check(CLI::Range(400, 8000));
  const std::map<std::string, MapPanel> panels{
      {"top", MapPanel::kTop}, {"perspective", MapPanel::kPerspective}, {"coverage", MapPanel::kCoverage}, {"all", MapPanel::kAll}};
  command->add_option("--view", arguments->panel, "What to draw (default all)")->transform(tools::named_choice(panels));
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace camloc::mapping
