// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// camloc-map build: a recording becomes a map file. Arguments become a BuildRequest here; build_map does the work, watched by the
// terminal, and its summary is printed as a table or JSON.
#include <CLI/CLI.hpp>
#include <filesystem>
#include <map>
#include <memory>

#include "core/io/camera_file.h"
#include "core/map/map_view.h"
#include "tools/camloc-map/commands.h"
#include "tools/common/command_line.h"
#include "tools/common/named_choice.h"
#include "tools/common/terminal_observer.h"
#include "tools/mapping/build/map_pipeline.h"

namespace camloc::mapping {
namespace {

constexpr const char* kFooter =
    "Examples\n"
    "  camloc-map build --sequence walk/ --camera camera.toml --out building.cmap\n"
    "  camloc-map build --sequence data/kitchen --camera config/cameras/7scenes.toml --poses embedded --exclude ::50 \\\n"
    "      --out kitchen.cmap\n"
    "  camloc-map build --sequence tuesday/ --camera camera.toml --extend building.cmap --out building.cmap --max-bytes 3MB\n"
    "Without --poses SLAM finds out where the camera was. Ctrl-C finishes a map of what was seen so far, and --resume goes on from\n"
    "there; with --poses it stops without touching an existing map. Exit code: 0 done, 1 failed, 2 wrong usage or configuration.";

struct BuildArguments {
  BuildRequest request;
  std::string camera_path;
  bool is_json = false;
};

/// --extend may be --out: the old map is in the new one.
Status check_outputs_of(const BuildArguments& arguments) {
  const BuildRequest& request = arguments.request;
  std::vector<tools::NamedPath> outputs{{"--out", request.map_path}};
  if (request.frames.poses.empty()) outputs.push_back({"--out (its .views)", frame_log_path(request.map_path)});
  if (!request.trajectory_path.empty()) outputs.push_back({"--trajectory", request.trajectory_path});
  std::vector<tools::NamedPath> inputs{{"--sequence", request.frames.sequence},  {"--camera", arguments.camera_path},
                                       {"--poses", request.frames.poses},        {"--accelerometer", request.accelerometer_path},
                                       {"--points", request.survey.points_path}, {"--observed", request.survey.observed_path}};
  Status status = tools::check_outputs(outputs, inputs);
  if (status.is_ok() && !request.extend_path.empty())
    status = tools::check_outputs({outputs.begin() + 1, outputs.end()}, {{"--extend", request.extend_path}});
  return status;
}

Status check_arguments(const BuildArguments& arguments) {
  const BuildRequest& request = arguments.request;
  if (const Status outputs = check_outputs_of(arguments); !outputs.is_ok()) return outputs;
  const bool has_poses = !request.frames.poses.empty();
  if (has_poses && request.is_resumed) return {ErrorCode::kInvalid, "--resume: goes with a build without --poses"};
  if (has_poses && !request.trajectory_path.empty())
    return {ErrorCode::kInvalid, "--trajectory: with --poses the trajectory is known already"};
  if (has_poses && !request.survey.points_path.empty())
    return {ErrorCode::kInvalid, "--points: goes with a build without --poses; 'camloc map georef' fits a finished map"};
  if (!request.extend_path.empty()) {
    if (!request.trajectory_path.empty())
      return {ErrorCode::kInvalid, "--trajectory: a recording that extends a map is deformed onto it; build it alone for its trajectory"};
    if (const auto extended = MapView::open(request.extend_path); !extended.is_ok()) return extended.status().with_context("--extend");
  }
  if (request.is_resumed && !std::filesystem::exists(frame_log_path(request.map_path)))
    return {ErrorCode::kInvalid, "--resume: there is no interrupted build of " + request.map_path + "; run it without --resume"};
  return Status::ok();
}

int run(BuildArguments arguments) {
  BuildRequest& request = arguments.request;
  const auto camera = read_camera_file(arguments.camera_path);
  if (!camera.is_ok()) return report_error(camera.status(), 2);
  request.camera = camera.value();
  if (const Status checked = check_arguments(arguments); !checked.is_ok()) return report_error(checked, 2);
  BuildSummary summary;
  const Status built = build_map(request, *std::make_unique<tools::TerminalObserver>(), &summary);  // its line ends before the report
  if (!built.is_ok()) return report(built);
  if (summary.reading.num_corrupt > 0) {
    tools::print_error("camloc-map", std::to_string(summary.reading.num_corrupt) + " of " + std::to_string(summary.num_selected) +
                                         " frames left out because they could not be read, the first: " + summary.reading.first_corrupt);
  }
  if (summary.survey && !summary.survey->is_written) {
    tools::print_error("camloc-map", request.survey.points_path + ": " + summary.survey->fit.problem +
                                         "; the map was written without site coordinates, 'camloc map georef' adds them");
  }
  const std::string text = arguments.is_json ? format_json(summary) : format_table(summary);
  const bool is_printed = tools::print_text(text);
  const bool is_complete = !summary.survey || summary.survey->is_written;
  return is_printed && is_complete ? 0 : 1;
}

}  // namespace

void add_build_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<BuildArguments>();
  BuildRequest& request = arguments->request;
  request.frames.poses.clear();
  CLI::App* command = app.add_subcommand("build", "Makes a map file from a recorded RGB-D walk.");
  command->footer(kFooter);
  command
      ->add_option("--sequence", request.frames.sequence,
                   "Recording: replay://DIR or a folder; TUM RGB-D, associations.txt, 7-Scenes or ScanNet layout")
      ->required();
  command->add_option("--camera", arguments->camera_path, "Calibration: our TOML, or YAML of kalibr, ROS, OpenCV")->required();
  command->add_option("--out", request.map_path, "Map file to write; replaced only when the new one is complete")->required();
  command->add_option("--poses", request.frames.poses,
                      "Poses that are known: 'embedded' (those of the recording), a trajectory file in TUM format, or colmap:DIR (a "
                      "COLMAP text model of the colour images); default: found by SLAM");
  command->add_option("--frames", request.frames.include, "Frames to use: start:stop:step[,...], Python slices (default: all)");
  command->add_option("--exclude", request.frames.exclude, "Frames to leave out, same notation");
  command
      ->add_option("--pair-ms", request.frames.pair_ms,
                   "How far a colour image and its depth image may be apart, milliseconds (default 20)")
      ->check(CLI::Range(0.0, 1000.0));
  command->add_option("--max-bytes", request.map.max_bytes, "Size limit of the file; the most useful landmarks are kept (accepts KB, MB)")
      ->transform(CLI::AsSizeValue(true));
  command->add_option("--extend", request.extend_path,
                      "Map of the same building that the recording is added to, with its frame and name; --max-bytes then limits the "
                      "merged map. --out may be that map itself");
  command->add_option("--name", request.name, "Name of the map, at most 63 bytes (default: the folder's)")
      ->check([](const std::string& name) { return name.size() <= 63 ? std::string() : std::string("longer than 63 bytes"); });
  const std::map<std::string, PoseCamera> cameras{
      {"auto", PoseCamera::kAuto}, {"color", PoseCamera::kColor}, {"depth", PoseCamera::kDepth}};
  command
      ->add_option("--poses-of", request.frames.pose_camera,
                   "Camera the poses belong to (default auto: embedded ones as the camera file says, a file's: color)")
      ->transform(tools::named_choice(cameras));
  command->add_option("--trajectory", request.trajectory_path, "Write where the camera was in each frame, TUM format");
  command->add_flag("--believe-poses", request.believes_poses, "Make a map even of poses that the images contradict")->needs("--poses");
  command->add_flag("--resume", request.is_resumed, "Go on with a build of the same map that was interrupted");
  command->add_flag("!--no-level", request.is_levelled, "Do not turn the map so that z points up");
  command->add_option(
      "--accelerometer", request.accelerometer_path,
      "Readings that say which way is up, 'timestamp ax ay az' (default: the floor, or accelerometer.txt of the recording)");
  CLI::Option* points = command->add_option("--points", request.survey.points_path,
                                            "Surveyed control points, 'name x y z [sigma_m]': they hold the map and fix it in the site");
  CLI::Option* observed =
      command->add_option("--observed", request.survey.observed_path, "Where they are seen, 'name pixel FRAME u v [sigma_px]'")
          ->needs(points);
  points->needs(observed);
  command->add_flag("--exclude-suspects", request.survey.is_excluding_suspects, "Leave out control points that the others contradict")
      ->needs(points);
  command->add_flag("--json", arguments->is_json, "Print the summary as JSON");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace camloc::mapping
