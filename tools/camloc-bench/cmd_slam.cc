// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// `camloc bench slam`: the map of a recording without poses, with SLAM's numbers as they are and as --set changes them, side by side.
// It is `camloc map build` that is run, so that what is compared is what users get.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/io/camera_file.h"
#include "tools/camloc-bench/commands.h"
#include "tools/common/command_line.h"
#include "tools/common/terminal_observer.h"
#include "tools/evaluation/trajectory_error.h"
#include "tools/mapping/build/map_pipeline.h"

namespace camloc::bench {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kPrefix = "slam.";

struct SlamArguments {
  mapping::BuildRequest request;
  std::string camera_path, reference_path, folder;
  std::vector<std::string> settings;
  bool is_json = false;
};

/// One contestant: a map, and how far its trajectory is from the reference.
struct SlamRun {
  std::string name;
  mapping::BuildSummary summary;
  double cpu_s = 0;
  std::optional<tools::TrajectoryErrors> errors;
};

/// The folder that is wanted, which stays, or one that is gone with its last owner.
Result<std::shared_ptr<const fs::path>> open_folder(const std::string& wanted) {
  std::error_code error;
  if (!wanted.empty()) {
    fs::create_directories(wanted, error);
    if (!error) return std::make_shared<const fs::path>(wanted);
  } else {
    std::string name = (fs::temp_directory_path(error) / "camloc-bench-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) error = std::error_code(errno, std::generic_category());
    const auto remove = [](const fs::path* path) {
      std::error_code ignored;
      fs::remove_all(*path, ignored);
      delete path;
    };
    if (!error) return std::shared_ptr<const fs::path>(new fs::path(name), remove);
  }
  return Status(ErrorCode::kIo, wanted + ": cannot make the folder: " + error.message());
}

Result<SlamNumbers> changed_numbers(const std::vector<std::string>& settings) {
  SlamNumbers numbers;
  for (const std::string& setting : settings) {
    if (setting.rfind(kPrefix, 0) != 0) return Status(ErrorCode::kInvalid, "--set " + setting + ": give slam.NAME=VALUE");
    const Status set = set_number(slam_number_table(), std::string_view(setting).substr(std::string_view(kPrefix).size()), &numbers);
    if (!set.is_ok()) return set.with_context("--set");
  }
  return numbers;
}

/// The poses to compare with; none where nobody named any and the recording has none.
Result<std::vector<StampedPose>> read_reference(const SlamArguments& arguments) {
  const bool is_given = !arguments.reference_path.empty();
  const std::string path = is_given ? arguments.reference_path : arguments.request.frames.sequence;
  auto recorded = tools::read_recorded_poses(path, "", tools::depth_camera_offset(arguments.request.camera));
  if (recorded.is_ok()) return std::move(recorded->poses);
  if (is_given) return recorded.status();
  return std::vector<StampedPose>();
}

Result<SlamRun> build(const SlamArguments& arguments, const std::string& name, const SlamNumbers& numbers, const fs::path& folder,
                      const std::vector<StampedPose>& reference) {
  mapping::BuildRequest request = arguments.request;
  request.slam.numbers = numbers;
  request.map_path = (folder / (name + ".cmap")).string();
  request.trajectory_path = (folder / (name + ".tum")).string();
  SlamRun run;
  run.name = name;
  const std::clock_t started = std::clock();
  tools::TerminalObserver observer;
  if (const Status built = mapping::build_map(request, observer, &run.summary); !built.is_ok()) return built;
  run.cpu_s = static_cast<double>(std::clock() - started) / CLOCKS_PER_SEC;
  if (reference.empty()) return run;
  const auto trajectory = tools::read_trajectory(request.trajectory_path);
  if (!trajectory.is_ok()) return trajectory.status();
  const auto at = [&](std::int64_t stamp_ns) { return pose_at(reference, stamp_ns); };
  run.errors = tools::compare(*trajectory, at, run.summary.num_selected, tools::align_by_positions(*trajectory, at));
  return run;
}

void print_table(const std::vector<SlamRun>& runs) {
  std::printf("%-10s %10s %10s %8s %8s %10s %10s %6s %6s %10s %10s\n", "", "ATE cm", "median cm", "cpu s", "wall s", "keyframes",
              "landmarks", "loops", "lost", "median px", "depth cm");
  for (const SlamRun& run : runs) {
    const mapping::SlamSummary& slam = *run.summary.slam;
    const std::string ate = run.errors ? std::to_string(100 * run.errors->translation_m.rmse).substr(0, 6) : "-";
    const std::string median = run.errors ? std::to_string(100 * run.errors->translation_m.median).substr(0, 6) : "-";
    std::printf("%-10s %10s %10s %8.1f %8.1f %10u %10u %6u %6u %10.3f %10.2f\n", run.name.c_str(), ate.c_str(), median.c_str(), run.cpu_s,
                run.summary.seconds, slam.counts.num_keyframes, slam.counts.num_landmarks, slam.counts.num_loops, slam.counts.num_lost,
                slam.fit.median_px, 100 * slam.fit.median_depth_m);
  }
}

Json to_json(const SlamRun& run) {
  const mapping::SlamSummary& slam = *run.summary.slam;
  Json json{{"map", run.summary.map_path},
            {"cpu_s", run.cpu_s},
            {"wall_s", run.summary.seconds},
            {"frames", run.summary.num_selected},
            {"keyframes", slam.counts.num_keyframes},
            {"landmarks", slam.counts.num_landmarks},
            {"loops", slam.counts.num_loops},
            {"lost", slam.counts.num_lost},
            {"segments", slam.counts.num_segments},
            {"median_px", slam.fit.median_px},
            {"median_depth_m", slam.fit.median_depth_m}};
  if (run.errors) {
    const auto& e = *run.errors;
    json["trajectory_error_m"] = {{"rmse", e.translation_m.rmse}, {"median", e.translation_m.median}, {"max", e.translation_m.max}};
    json["rotation_error_deg"] = {{"rmse", e.rotation_deg.rmse}, {"median", e.rotation_deg.median}};
  }
  return json;
}

Status run(SlamArguments& arguments) {
  const auto camera = read_camera_file(arguments.camera_path);
  if (!camera.is_ok()) return camera.status();
  arguments.request.camera = camera.value();
  const auto changed = changed_numbers(arguments.settings);
  if (!changed.is_ok()) return changed.status();
  const auto reference = read_reference(arguments);
  if (!reference.is_ok()) return reference.status();
  const auto folder = open_folder(arguments.folder);
  if (!folder.is_ok()) return folder.status();
  std::vector<std::pair<std::string, SlamNumbers>> contestants{{"default", SlamNumbers()}};
  if (!arguments.settings.empty()) contestants.emplace_back("changed", *changed);
  std::vector<SlamRun> runs;
  for (const auto& [name, numbers] : contestants) {
    auto built = build(arguments, name, numbers, **folder, *reference);
    if (!built.is_ok()) return built.status();
    runs.push_back(std::move(built).value());
  }
  if (!arguments.is_json) {
    print_table(runs);
    return Status::ok();
  }
  Json json;
  for (const SlamRun& one : runs) json[one.name] = to_json(one);
  if (!arguments.settings.empty()) json["changed"]["set"] = arguments.settings;
  std::printf("%s\n", json.dump(1).c_str());
  return Status::ok();
}

std::string footer() {
  std::string text =
      "Example: camloc bench slam --sequence recordings/kitchen --camera 7scenes.toml --set slam.depth_in_tracking=0\n"
      "Numbers that --set changes, and what they are:\n";
  const SlamNumbers defaults;
  for (const auto& entry : slam_number_table()) {
    char value[32];
    std::snprintf(value, sizeof value, "%g", number_of(entry, defaults));
    text += std::string("  ") + kPrefix + entry.name + "=" + value + (*entry.unit != 0 ? std::string(" ") + entry.unit : "") + "\n";
  }
  return text + "core/slam/slam_numbers.cc says what each decides. Exit code: 0 done, 1 failed, 2 wrong usage or configuration.";
}

}  // namespace

CLI::App* add_slam_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<SlamArguments>();
  mapping::BuildRequest& request = arguments->request;
  request.frames.poses.clear();
  CLI::App* command = app.add_subcommand("slam", "Accuracy and time of the map of a walk without poses, as it is and as --set changes it");
  command->footer(footer());
  command->add_option("--sequence", request.frames.sequence, "Folder or URL of the recording")->required();
  command->add_option("--camera", arguments->camera_path, "Camera file")->required();
  command->add_option("--reference", arguments->reference_path,
                      "Poses to compare with: a trajectory in TUM format, or a recording (default: the recording's own)");
  command->add_option("--frames", request.frames.include, "Frames to use: start:stop:step[,...]");
  command->add_option("--set", arguments->settings, "slam.NAME=VALUE, may be repeated");
  command->add_option("--keep", arguments->folder,
                      "Folder to leave maps and trajectories in: default.cmap, default.tum, changed.cmap, changed.tum");
  command->add_flag("--json", arguments->is_json, "Print JSON");
  command->callback([arguments, &exit_code] { exit_code = tools::report("camloc", run(*arguments)); });
  return command;
}

}  // namespace camloc::bench
