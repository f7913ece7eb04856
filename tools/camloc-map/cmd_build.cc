// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// camloc-map build: a recorded RGB-D sequence with poses becomes a map file.
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "core/map/map_builder.h"
#include "core/map/map_writer.h"
#include "drivers/camera_file.h"
#include "drivers/frame_source.h"
#include "tools/camloc-map/build_report.h"
#include "tools/camloc-map/commands.h"
#include "tools/camloc-map/posed_frames.h"
#include "tools/common/command_line.h"
#include "tools/common/interrupt.h"
#include "tools/common/output_path.h"
#include "tools/common/progress_line.h"

namespace camloc::map_tool {
namespace {

using tools::InterruptGuard;
using tools::ProgressLine;

constexpr const char* kFooter =
    "Example: a map from every frame but each 50th\n"
    "  camloc-map build --sequence replay://data/kitchen --camera config/cameras/7scenes.toml --poses embedded \\\n"
    "      --exclude ::50 --out kitchen.cmap\n"
    "Ctrl-C stops without touching an existing map. Exit code: 0 done, 1 failed, 2 wrong usage or configuration.";

struct BuildArguments {
  PosedFramesRequest frames;
  std::string camera_path, map_path, name;
  std::uint64_t max_bytes = 0;
  bool is_json = false;
};

Status interrupted_status(const std::string& map_path) {
  const bool is_there = std::filesystem::exists(map_path);
  return {ErrorCode::kIo, "interrupted; " + map_path + (is_there ? " is unchanged" : " was not written")};
}

/// Feeds every posed frame to the builder. Broken frames are counted, a wrong image size ends the build.
Status add_frames(const PosedFrames& frames, MapBuilder* builder, BuildSummary* summary, ProgressLine* progress) {
  auto source = open_frame_source(frames.url);
  if (!source.is_ok()) return source.status();
  FrameBuffer buffer;
  for (std::uint64_t done = 0; !InterruptGuard::is_interrupted();) {
    const Status status = source.value()->next(&buffer, std::chrono::milliseconds(1000));
    if (status.code() == ErrorCode::kEnd) return Status::ok();
    if (status.code() == ErrorCode::kTimeout) continue;
    progress->show(++done, std::to_string(builder->progress().num_landmarks_before) + " landmarks");
    if (status.code() == ErrorCode::kCorrupt) {
      if (summary->num_broken++ == 0) summary->first_broken = status.message();
      continue;
    }
    if (!status.is_ok()) return status;
    const auto pose = frames.T_map_camera_of_frame.find(buffer.sequence);
    if (pose == frames.T_map_camera_of_frame.end()) continue;
    if (buffer.depth.pixels.empty() || buffer.depth.width == 0) {
      ++summary->num_without_depth;
      continue;
    }
    if (const Status added = builder->add_frame(buffer.view(), pose->second); !added.is_ok()) return added;
  }
  return Status::ok();
}

Status build(const BuildArguments& arguments, const RgbdCamera& camera, const PosedFrames& frames, BuildSummary* summary) {
  const auto start = std::chrono::steady_clock::now();
  const InterruptGuard guard;
  MapBuildOptions options;
  options.max_bytes = arguments.max_bytes;
  MapBuilder builder(camera, options);
  ProgressLine progress(frames.T_map_camera_of_frame.size());
  if (const Status added = add_frames(frames, &builder, summary, &progress); !added.is_ok()) return added;
  if (InterruptGuard::is_interrupted()) return interrupted_status(arguments.map_path);
  if (const auto num_usable = frames.T_map_camera_of_frame.size() - summary->num_broken; num_usable == 0) {
    return {ErrorCode::kCorrupt, "none of " + std::to_string(summary->num_broken) + " frames could be read, the first because of " +
                                     summary->first_broken};
  }
  progress.say("choosing landmarks and keyframes, training words ...");
  auto map = builder.finish(&summary->build);
  if (!map.is_ok()) return map.status();
  map->name = arguments.name;
  if (InterruptGuard::is_interrupted()) return interrupted_status(arguments.map_path);
  if (const Status written = write_map(map.value(), arguments.map_path); !written.is_ok()) return written;
  summary->pose_sigma_m = map->pose_sigma_m;
  summary->pose_sigma_rad = map->pose_sigma_rad;
  summary->seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return Status::ok();
}

int run(BuildArguments arguments) {
  const auto camera = read_camera_file(arguments.camera_path);
  if (!camera.is_ok()) return report_error(camera.status(), 2);
  if (const Status output = tools::check_output_path("--out", arguments.map_path); !output.is_ok()) return report_error(output, 2);
  const auto frames = find_posed_frames(arguments.frames, camera.value());
  if (!frames.is_ok()) return report_error(frames.status(), frames.status().code() == ErrorCode::kInvalid ? 2 : 1);
  if (arguments.name.empty()) {
    arguments.name = std::filesystem::weakly_canonical(frames.value().folder).filename().string().substr(0, 63);
  }
  BuildSummary summary;
  summary.map_path = arguments.map_path;
  summary.sequence = arguments.frames.sequence;
  summary.camera = camera.value().name;
  summary.num_recorded = frames.value().num_recorded;
  summary.num_selected = frames.value().num_selected;
  summary.num_without_pose = frames.value().num_without_pose;
  if (const Status built = build(arguments, camera.value(), frames.value(), &summary); !built.is_ok()) {
    return report_error(built, built.code() == ErrorCode::kInvalid ? 2 : 1);
  }
  if (summary.num_broken > 0) {
    tools::print_error("camloc-map", std::to_string(summary.num_broken) + " of " + std::to_string(frames.value().T_map_camera_of_frame.size()) +
                                         " frames left out because they could not be read, the first: " + summary.first_broken);
  }
  const std::string text = arguments.is_json ? format_json(summary) : format_table(summary);
  return std::fputs(text.c_str(), stdout) >= 0 && std::fflush(stdout) == 0 ? 0 : 1;
}

}  // namespace

void add_build_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<BuildArguments>();
  CLI::App* command = app.add_subcommand("build", "Makes a map file from a recorded RGB-D sequence with poses.");
  command->footer(kFooter);
  command
      ->add_option("--sequence", arguments->frames.sequence, "Recording: replay://DIR or a folder, TUM RGB-D or 7-Scenes layout")
      ->required();
  command->add_option("--camera", arguments->camera_path, "Calibration: our TOML, or YAML of kalibr, ROS, OpenCV")->required();
  command
      ->add_option("--poses", arguments->frames.poses, "'embedded' (those of the recording) or a trajectory file in TUM format")
      ->required();
  command->add_option("--out", arguments->map_path, "Map file to write; replaced only when the new one is complete")->required();
  command->add_option("--frames", arguments->frames.include,
                      "Frames to use: start:stop:step[,...], Python slices (default: all)");
  command->add_option("--exclude", arguments->frames.exclude, "Frames to leave out, same notation");
  command
      ->add_option("--max-bytes", arguments->max_bytes,
                   "Size limit of the file; the most useful landmarks are kept (accepts KB, MB)")
      ->transform(CLI::AsSizeValue(true));
  command->add_option("--name", arguments->name, "Name of the map, at most 63 bytes (default: the folder's)")
      ->check([](const std::string& name) { return name.size() <= 63 ? std::string() : std::string("longer than 63 bytes"); });
  const std::map<std::string, PoseCamera> cameras{
      {"auto", PoseCamera::kAuto}, {"color", PoseCamera::kColor}, {"depth", PoseCamera::kDepth}};
  command
      ->add_option("--poses-of", arguments->frames.pose_camera,
                   "Camera the poses belong to (default auto: embedded ones as the camera file says, a file's: color)")
      ->transform(CLI::CheckedTransformer(cameras));
  command->add_flag("--json", arguments->is_json, "Print the summary as JSON");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace camloc::map_tool
