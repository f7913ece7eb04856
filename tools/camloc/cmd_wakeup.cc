// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// `camloc wakeup`: the kidnapped robot as a test of a map. Where does a camera that is switched on find itself, how fast, and is it
// ever wrong?
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>

#include "tools/camloc/commands.h"
#include "tools/common/command_line.h"
#include "tools/common/json_text.h"
#include "tools/common/terminal_observer.h"
#include "tools/common/text_format.h"
#include "tools/evaluation/sequence_run.h"
#include "tools/evaluation/top_view.h"
#include "tools/evaluation/wakeups.h"

namespace camloc::tools {
namespace {

constexpr std::uint64_t kMaxCount = 100'000;
constexpr double kMaxSeconds = 600;

struct WakeupArguments {
  SequenceRunOptions run;
  WakeupOptions wakeup;
  std::string reference_path, png_path;
  bool is_json = false;
};

const std::string& reference_of(const WakeupArguments& arguments) {
  return arguments.reference_path.empty() ? arguments.run.sequence_url : arguments.reference_path;
}

std::map<std::string, std::uint64_t> reasons_of_never(std::span<const Wakeup> wakeups) {
  std::map<std::string, std::uint64_t> reasons;
  for (const Wakeup& wakeup : wakeups) {
    if (wakeup.is_complete && !wakeup.seconds_to_fix) ++reasons[to_string(wakeup.last_reason)];
  }
  return reasons;
}

Json wakeup_json(const Wakeup& wakeup) {
  return {{"first_frame", wakeup.first_frame},
          {"position_m", wakeup.T_map_camera_start ? json_of(wakeup.T_map_camera_start->translation) : Json(nullptr)},
          {"frames", wakeup.num_frames},
          {"localized", wakeup.num_localized},
          {"misleading", wakeup.num_misleading},
          {"seconds_to_fix", wakeup.seconds_to_fix ? Json(*wakeup.seconds_to_fix) : Json(nullptr)},
          {"first_fix_error_m", wakeup.seconds_to_fix ? Json(wakeup.first_fix_error_m) : Json(nullptr)},
          {"first_fix_misleading", wakeup.is_first_fix_misleading},
          {"last_reason", to_string(wakeup.last_reason)},
          {"complete", wakeup.is_complete}};
}

void print_json(const WakeupSummary& summary, std::span<const Wakeup> wakeups) {
  Json starts = Json::array();
  for (const Wakeup& wakeup : wakeups) starts.push_back(wakeup_json(wakeup));
  const Json document{{"starts", summary.num_starts},
                      {"cut_short", summary.num_cut_short},
                      {"fixed", summary.num_fixed},
                      {"fixed_at_once", summary.num_fixed_at_once},
                      {"never", summary.num_never},
                      {"wrong_first_fixes", summary.num_wrong_first},
                      {"seconds_to_fix", {{"p50", summary.fix_p50_s}, {"p95", summary.fix_p95_s}}},
                      {"localized", summary.num_localized},
                      {"misleading", summary.num_misleading},
                      {"wakeups", starts}};
  std::printf("%s\n", document.dump(1).c_str());
}

void print_table(const WakeupSummary& summary, std::span<const Wakeup> wakeups, double seconds) {
  const auto percent = [](std::uint64_t part, std::uint64_t whole) {
    return whole == 0 ? 0.0 : 100.0 * static_cast<double>(part) / static_cast<double>(whole);
  };
  std::printf("starts        %llu of %g s; %llu ended with the recording before a fix\n", llu(summary.num_starts), seconds,
              llu(summary.num_cut_short));
  std::printf("fixed         %llu (%.1f %%), %llu of them in the first frame; time to fix p50 %.2f s, p95 %.2f s\n", llu(summary.num_fixed),
              percent(summary.num_fixed, summary.num_starts), llu(summary.num_fixed_at_once), summary.fix_p50_s, summary.fix_p95_s);
  std::printf("never         %llu\n", llu(summary.num_never));
  for (const auto& [reason, count] : reasons_of_never(wakeups)) std::printf("  at the end: %s: %llu\n", reason.c_str(), llu(count));
  std::printf("first fix     wrong %llu (farther off than 25 cm or 10 deg)\n", llu(summary.num_wrong_first));
  std::printf("poses         %llu LOCALIZED, %llu misleading (%.2f %%)\n", llu(summary.num_localized), llu(summary.num_misleading),
              percent(summary.num_misleading, summary.num_localized));
  for (const Wakeup& wakeup : wakeups) {
    if (wakeup.num_misleading == 0) continue;
    std::printf("  frame %llu: %u of %u poses misleading, first fix %.2f m off\n", llu(wakeup.first_frame), wakeup.num_misleading,
                wakeup.num_localized, wakeup.first_fix_error_m);
  }
}

/// Starts as dots: how far off the first pose was, and a line for the truth between them.
Status draw(const WakeupArguments& arguments, const MapView& map, const std::vector<StampedPose>& truth, const WakeupSummary& summary,
            std::span<const Wakeup> wakeups) {
  TopView view;
  view.map = &map;
  for (const StampedPose& pose : truth) view.truth.push_back(pose.T_world_camera);
  for (const Wakeup& wakeup : wakeups) {
    if (!wakeup.T_map_camera_start || !wakeup.seconds_to_fix) continue;
    view.estimate.push_back(*wakeup.T_map_camera_start);
    view.error_m.push_back(wakeup.num_misleading > 0 ? std::max(wakeup.first_fix_error_m, kMisleading.translation_m + 0.01)
                                                     : wakeup.first_fix_error_m);
  }
  view.title =
      text_of("%llu of %llu starts fixed, %llu in the first frame, %llu first fixes wrong, %llu poses misleading", llu(summary.num_fixed),
              llu(summary.num_starts), llu(summary.num_fixed_at_once), llu(summary.num_wrong_first), llu(summary.num_misleading));
  return write_top_view(view, arguments.png_path);
}

Status wakeup(const WakeupArguments& arguments) {
  if (!arguments.png_path.empty()) {
    std::vector<NamedPath> inputs = inputs_of(arguments.run);
    inputs.push_back({"--reference", arguments.reference_path});
    if (Status status = check_outputs({{"--png", arguments.png_path}}, inputs); !status) return status;
  }
  auto run = open_sequence_run(arguments.run);
  if (!run) return run.status();
  if (!run->source->info().num_frames)
    return {ErrorCode::kInvalid, arguments.run.sequence_url + ": is no recording; a live camera cannot be woken up at its places again"};
  const auto truth = read_recorded_poses(reference_of(arguments), "", depth_camera_offset(run->camera));
  if (!truth) return truth.status();
  const auto truth_at = [&truth](std::int64_t stamp_ns) { return pose_at(truth->poses, stamp_ns); };

  WakeupRun wakeups(*run->map, run->camera, run->localizer_options, truth_at, arguments.wakeup, *run->source->info().num_frames,
                    run->coarse.get());
  TerminalObserver observer;
  std::uint64_t num_done = 0;
  const auto counts = read_perturbed_frames(
      *run,
      [&](const Frame& frame) {
        wakeups.process(frame);
        observer.show("frame", ++num_done, *run->source->info().num_frames, std::to_string(wakeups.results().size()) + " starts");
      },
      observer);
  observer.show("", 0, 0, "");
  if (!counts) return counts.status();
  if (InterruptGuard::is_interrupted()) return {ErrorCode::kIo, "interrupted after " + std::to_string(counts->num_frames) + " frames"};
  warn_of_corrupt_frames("camloc", *counts);
  const bool has_truth = std::any_of(wakeups.results().begin(), wakeups.results().end(),
                                     [](const Wakeup& start) { return start.T_map_camera_start.has_value(); });
  if (!has_truth) {
    return {ErrorCode::kInvalid, reference_of(arguments) + ": has no pose at the times of the recording: nothing can be judged by it"};
  }
  const WakeupSummary summary = summarize(wakeups.results());
  if (arguments.is_json)
    print_json(summary, wakeups.results());
  else
    print_table(summary, wakeups.results(), arguments.wakeup.seconds);
  return arguments.png_path.empty() ? Status::ok() : draw(arguments, *run->map, truth->poses, summary, wakeups.results());
}

}  // namespace

void add_wakeup_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<WakeupArguments>();
  CLI::App* command = app.add_subcommand("wakeup", "Switch the localizer on at many places of a recording: does it ever mislead?");
  command->add_option("--map", arguments->run.map_path, "Map (.cmap)")->required();
  command->add_option("--sequence", arguments->run.sequence_url, "Folder or URL of the recording")->required();
  command->add_option("--camera", arguments->run.camera_path, "Camera file (TOML, or YAML of kalibr, ROS, OpenCV)")->required();
  command->add_option(
      "--reference", arguments->reference_path,
      "True poses in the map's frame: trajectory in TUM format, or folder of a recording with poses (default: the sequence)");
  command->add_option("--count", arguments->wakeup.count, "Cold starts, evenly over the frames")
      ->check(CLI::Range(std::uint64_t{1}, kMaxCount))
      ->capture_default_str();
  command->add_option("--seconds", arguments->wakeup.seconds, "How long each runs")
      ->check(CLI::Range(0.001, kMaxSeconds))
      ->capture_default_str();
  command->add_option("--frames", arguments->run.frames, "Frames to use: start:stop:step[,...], as Python slices (default: all)");
  command->add_option("--coarse", arguments->run.coarse_path,
                      "Coarse model of the map (camloc train), asked about lost frames: its answer is there with the next one");
  command->add_option("--set", arguments->run.numbers, "For experiments: localizer.NAME=VALUE; an unknown NAME lists them all");
  command->add_flag("!--no-depth", arguments->run.use_depth, "Ignore measured depth");
  command->add_flag("--json", arguments->is_json, "Print JSON, with a record for each start");
  command->add_option("--png", arguments->png_path, "Write a top view: where the starts were, and how far off their first pose");
  command->footer(
      "Example: camloc wakeup --map building.cmap --sequence building/day2 --camera building/camera.toml --png wakeups.png\n"
      "Exit code: 0 done (however many mislead), 1 failed or interrupted, 2 wrong usage or configuration.");
  command->callback([arguments, &exit_code] { exit_code = report(wakeup(*arguments)); });
}

}  // namespace camloc::tools
