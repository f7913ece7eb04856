// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// `camloc localize`: every frame of a recording against a map; a trajectory and, on request, everything known per frame.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>

#include "core/io/file_bytes.h"
#include "tools/camloc/commands.h"
#include "tools/common/command_line.h"
#include "tools/common/json_text.h"
#include "tools/common/terminal_observer.h"
#include "tools/common/text_format.h"
#include "tools/common/trajectory_file.h"
#include "tools/evaluation/sequence_run.h"

namespace camloc::tools {
namespace {

struct LocalizeArguments {
  SequenceRunOptions run;
  std::string mode = "track";
  std::string out_path, json_path;
};

Json pose_json(const Localization& result) {
  if (!result.has_pose) return nullptr;
  return {{"position_m", json_of(result.T_map_camera.translation)}, {"orientation_wxyz", json_of(result.T_map_camera.rotation)}};
}

Json protection_json(const Protection& protection) {
  return {{"position_m", {protection.p95.position_m, protection.p999.position_m}},
          {"rotation_rad", {protection.p95.rotation_rad, protection.p999.rotation_rad}}};
}

Json latency_json(const Localization& result) {
  Json latency;
  for (int i = 0; i < kNumStages; ++i) {
    latency[to_string(static_cast<Stage>(i))] = 1e-6 * static_cast<double>(result.stage_ns[static_cast<std::size_t>(i)]);
  }
  return latency;
}

Json record_json(const Localization& result) {
  return {{"index", result.sequence},
          {"stamp", 1e-9 * static_cast<double>(result.stamp_ns)},
          {"state", to_string(result.state)},
          {"reason", to_string(result.reason)},
          {"pose", pose_json(result)},
          {"covariance", result.has_pose ? json_of(result.covariance) : Json(nullptr)},
          {"quality", result.quality},
          {"integrity_risk", result.integrity_risk},
          {"protection", result.has_pose ? protection_json(result.protection) : Json(nullptr)},
          {"tracked", result.is_tracked},
          {"proposed_by", result.proposed_by},
          {"features", result.num_features},
          {"visible", result.evidence.num_visible},
          {"matches", result.evidence.num_matches},
          {"inliers", result.evidence.num_inliers},
          {"inlier_ratio", result.evidence.inlier_ratio()},
          {"spread", result.evidence.spread},
          {"distinct_visible", result.evidence.num_distinct_visible},
          {"distinct_inliers", result.evidence.num_distinct_inliers},
          {"margin", result.standing.margin},
          {"lead", std::isfinite(result.standing.lead) ? Json(result.standing.lead) : Json(nullptr)},
          {"with_depth", result.evidence.num_with_depth},
          {"depth_agreement", result.evidence.depth_agreement},
          {"map_depth", result.evidence.num_map_depth},
          {"map_depth_agreement", result.evidence.map_depth_agreement},
          {"focal_scale", result.evidence.focal_scale},
          {"reset_counter", result.reset_counter},
          {"jump_m", result.jump_m},
          {"latency_ms", latency_json(result)}};
}

void print_summary(const std::map<std::string, std::uint64_t>& states, const std::map<std::string, std::uint64_t>& reasons,
                   const FrameCounts& counts, const CalibrationHealth& calibration) {
  std::printf("frames      %llu\n", llu(counts.num_frames));
  if (counts.num_corrupt > 0) std::printf("unreadable  %llu\n", llu(counts.num_corrupt));
  for (const auto& [state, count] : states) std::printf("%-11s %llu\n", state.c_str(), llu(count));
  for (const auto& [reason, count] : reasons) std::printf("  not localized: %s: %llu\n", reason.c_str(), llu(count));
  if (calibration.is_suspect) {
    std::printf(
        "WARNING     calibration: the images fit the map with a focal length %.1f %% %s than the camera file says; check the camera file\n",
        100.0 * std::abs(calibration.focal_scale - 1.0), calibration.focal_scale > 1.0 ? "longer" : "shorter");
  }
}

/// What a run found out, frame by frame.
struct RunLog {
  EstimatedTrajectory trajectory;
  Json records = Json::array();
  std::map<std::string, std::uint64_t> states, reasons;

  void add(const Localization& result, bool has_records) {
    ++states[to_string(result.state)];
    if (result.state == State::kLocalized) {
      trajectory.poses.push_back({result.stamp_ns, result.T_map_camera, result.covariance});
    } else {
      ++reasons[to_string(result.reason)];
    }
    if (has_records) records.push_back(record_json(result));
  }
};

Json document_json(const LocalizeArguments& arguments, const RunLog& log, const FrameCounts& counts, const CalibrationHealth& calibration) {
  const Json health{{"is_suspect", calibration.is_suspect}, {"focal_scale", calibration.focal_scale}, {"frames", calibration.num_frames}};
  return {{"map", arguments.run.map_path},
          {"sequence", arguments.run.sequence_url},
          {"mode", arguments.mode},
          {"summary", {{"frames", counts.num_frames}, {"unreadable", counts.num_corrupt}, {"states", log.states}, {"calibration", health}}},
          {"frames", log.records}};
}

/// Trajectory and records, whole files or none.
Status write_results(const LocalizeArguments& arguments, const SequenceRun& run, const FrameCounts& counts, RunLog* log) {
  const CalibrationHealth& calibration = run.localizer->calibration();
  log->trajectory.num_frames = counts.num_frames;
  if (run.camera.poses_are_of_depth_camera) log->trajectory.T_color_depth = run.camera.T_color_depth;
  if (calibration.is_suspect) log->trajectory.suspect_focal_scale = calibration.focal_scale;
  if (Status status = replace_file(arguments.out_path, format_trajectory(log->trajectory)); !status) return status;
  if (arguments.json_path.empty()) return Status::ok();
  return replace_file(arguments.json_path, json_text(document_json(arguments, *log, counts, calibration), 1));
}

Status localize(const LocalizeArguments& arguments) {
  std::vector<NamedPath> outputs{{"--out", arguments.out_path}};
  if (!arguments.json_path.empty()) outputs.push_back({"--json", arguments.json_path});
  if (Status status = check_outputs(outputs, inputs_of(arguments.run)); !status) return status;
  auto run = open_sequence_run(arguments.run);
  if (!run) return run.status();

  for (const std::string& note : run->source->info().notes) print_error("camloc", note);
  if (arguments.run.use_depth && run->source->info().depth_width == 0 && run->source->info().color_width != 0) {
    print_error("camloc", arguments.run.sequence_url + ": no frame has depth; localizing by colour alone");
  }
  RunLog log;
  TerminalObserver observer;
  const std::uint64_t num_frames = run->source->info().num_frames.value_or(0);
  std::uint64_t num_done = 0;
  const auto process = [&](const Frame& frame) {
    log.add(run->localize(frame), !arguments.json_path.empty());
    observer.show("frame", ++num_done, num_frames, std::to_string(log.trajectory.poses.size()) + " localized");
  };
  const auto counts = read_perturbed_frames(*run, process, observer);
  observer.show("", 0, 0, "");  // the summary takes its place
  if (!counts) return counts.status();
  if (Status status = write_results(arguments, *run, *counts, &log); !status) return status;
  if (InterruptGuard::is_interrupted()) {
    return {ErrorCode::kIo, "interrupted after " + std::to_string(counts->num_frames) + " frames; " + arguments.out_path + " holds those"};
  }
  warn_of_corrupt_frames("camloc", *counts);
  print_summary(log.states, log.reasons, *counts, run->localizer->calibration());
  return Status::ok();
}

}  // namespace

void add_localize_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<LocalizeArguments>();
  CLI::App* command = app.add_subcommand("localize", "Localize every frame of a recording against a map");
  command->add_option("--map", arguments->run.map_path, "Map (.cmap)")->required();
  command->add_option("--sequence", arguments->run.sequence_url, "Folder or URL of the recording")->required();
  command->add_option("--camera", arguments->run.camera_path, "Camera file (TOML, or YAML of kalibr, ROS, OpenCV)")->required();
  command->add_option("--set", arguments->run.numbers, "For experiments: localizer.NAME=VALUE; an unknown NAME lists them all");
  command->add_option("--out", arguments->out_path, "Trajectory to write: TUM format, LOCALIZED frames, T_map_camera")->required();
  command->add_option("--frames", arguments->run.frames, "Frames to use: start:stop:step[,...], as Python slices (default: all)");
  command->add_option("--exclude", arguments->run.exclude, "Frames to leave out, same form");
  command->add_option("--mode", arguments->mode, "track: frames follow each other; single: every frame on its own")
      ->check(CLI::IsMember({"track", "single"}))
      ->capture_default_str();
  command
      ->add_option("--perturb", arguments->run.perturbations,
                   "Change every image first; may be repeated. gamma=0.5, contrast=0.6, exposure=0.4 (factors), noise=12 (sigma, grey "
                   "levels), blur=9 (pixels)")
      ->allow_extra_args(false);
  command->add_option(
      "--coarse", arguments->run.coarse_path,
      "Coarse model of the map (camloc train), asked about lost frames: its answer is there with the next one, in --mode single at once");
  command->add_option("--json", arguments->json_path, "Also write one record per frame to this file");
  command->add_flag("!--no-depth", arguments->run.use_depth, "Ignore measured depth");
  command->footer(
      "Example: every 50th frame, each as if the camera had just been switched on\n"
      "  camloc localize --map kitchen.cmap --sequence recordings/kitchen --camera 7scenes.toml --frames ::50 \\\n"
      "      --mode single --out traj.tum\n"
      "Ctrl-C stops after the current frame and writes what there is. Exit code: 0 done, 1 failed or interrupted,\n"
      "2 wrong usage or configuration.");
  command->callback([arguments, &exit_code] {
    arguments->run.is_single = arguments->mode == "single";
    exit_code = report(localize(*arguments));
  });
}

}  // namespace camloc::tools
