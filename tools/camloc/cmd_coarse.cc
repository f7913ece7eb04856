// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// `camloc coarse`: what a coarse model is, and how far off it is.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <numbers>

#include "core/coarse/coarse_model.h"
#include "tools/camloc/commands.h"
#include "tools/common/command_line.h"
#include "tools/common/json_text.h"
#include "tools/common/terminal_observer.h"
#include "tools/common/text_format.h"
#include "tools/evaluation/coarse_evaluation.h"
#include "tools/evaluation/sequence_run.h"

namespace camloc::tools {
namespace {

struct CoarseArguments {
  std::string model_path, reference_path;
  SequenceRunOptions run;
  bool is_json = false;
};

constexpr double kDegrees = 180 / std::numbers::pi;

Json info_json(const CoarseModel& model, std::uint64_t num_weights) {
  const CoarseModelInfo& info = model.info;
  const NetworkInputLayout& layout = info.layout;
  return {{"map_id", info.map_id},
          {"net", info.net},
          {"weights", num_weights},
          {"opset", model.onnx.opset},
          {"input",
           {{"channels", layout.channels},
            {"width", layout.width},
            {"height", layout.height},
            {"focal_px", layout.focal_px},
            {"mean", layout.mean},
            {"scale", layout.scale}}},
          {"training", info.training},
          {"training_frames", info.num_training_frames},
          {"training_camera", {{"fx", info.train_fx}, {"fy", info.train_fy}, {"width", info.train_width}, {"height", info.train_height}}},
          {"sigma_position_m", info.sigma_position_m},
          {"sigma_rotation_deg", info.sigma_rotation_rad * kDegrees}};
}

const char* channels_text(const NetworkInputLayout& layout) {
  if (layout.num_gray() == 1) return layout.has_depth() ? "grey and depth" : "grey";
  return layout.has_depth() ? "grey three times and depth" : "grey three times";
}

void print_info(const CoarseModel& model, std::uint64_t num_weights) {
  const CoarseModelInfo& info = model.info;
  const NetworkInputLayout& layout = info.layout;
  std::printf("map          %s\n", info.map_id.c_str());
  std::printf("network      %s, %.2f million weights, %zu operations\n", info.net.c_str(), 1e-6 * static_cast<double>(num_weights),
              model.onnx.nodes.size());
  std::printf("sees         %d x %d pixels at a focal length of %.1f, %s\n", layout.width, layout.height,
              static_cast<double>(layout.focal_px), channels_text(layout));
  std::printf("trained on   %u frames: %s\n", info.num_training_frames, info.training.c_str());
  std::printf("camera       %d x %d pixels, focal lengths %.1f %.1f\n", info.train_width, info.train_height,
              static_cast<double>(info.train_fx), static_cast<double>(info.train_fy));
  std::printf("error model  %.3f m and %.2f deg per axis, on frames held out in training\n", info.sigma_position_m,
              info.sigma_rotation_rad * kDegrees);
}

Status show_info(const CoarseArguments& arguments) {
  const auto model = read_coarse_model(arguments.model_path);
  if (!model) return model.status();
  std::uint64_t num_weights = 0;
  for (const OnnxTensor& tensor : model->onnx.weights) num_weights += tensor.values.size();
  if (arguments.is_json)
    std::printf("%s", json_text(info_json(*model, num_weights), 1).c_str());
  else
    print_info(*model, num_weights);
  return Status::ok();
}

Json errors_json(const CoarseErrors& errors) {
  const auto of = [](const ErrorStatistics& s) { return Json{{"median", s.median}, {"mean", s.mean}, {"p90", s.p90}, {"max", s.max}}; };
  return {{"answers", errors.num_answers}, {"translation_m", of(errors.translation_m)}, {"rotation_deg", of(errors.rotation_deg)}};
}

void print_json(const CoarseReport& report) {
  Json cnn = errors_json(report.cnn);
  cnn["nees"] = {{"mean", report.nees_mean}, {"median", report.nees_median}};
  cnn["milliseconds"] = {{"p50", report.locate_p50_ms}, {"p99", report.locate_p99_ms}};
  const Json document{
      {"frames", report.num_frames}, {"cnn", cnn}, {"retrieval", errors_json(report.retrieval)}, {"both", errors_json(report.both)}};
  std::printf("%s", json_text(document, 1).c_str());
}

void print_table(const CoarseReport& report) {
  std::printf("frames       %llu with a true pose\n", llu(report.num_frames));
  std::printf("             answers   median      mean       p90       max\n");
  const auto row = [](const char* name, const CoarseErrors& errors) {
    const ErrorStatistics &t = errors.translation_m, &r = errors.rotation_deg;
    std::printf("%-12s %7llu %8.3f  %8.3f  %8.3f  %8.3f  m\n", name, llu(errors.num_answers), t.median, t.mean, t.p90, t.max);
    std::printf("%-12s %7s %8.2f  %8.2f  %8.2f  %8.2f  deg\n", "", "", r.median, r.mean, r.p90, r.max);
  };
  row("cnn", report.cnn);
  row("retrieval", report.retrieval);
  row("both", report.both);
  std::printf("error model  NEES mean %.1f, median %.1f (honest: 6 and 5.3)\n", report.nees_mean, report.nees_median);
  std::printf("time         p50 %.1f ms, p99 %.1f ms a frame for the network\n", report.locate_p50_ms, report.locate_p99_ms);
}

Status evaluate(const CoarseArguments& arguments) {
  auto run = open_sequence_run(arguments.run);
  if (!run) return run.status();
  const std::string& reference = arguments.reference_path.empty() ? arguments.run.sequence_url : arguments.reference_path;
  const auto truth = read_recorded_poses(reference, "", depth_camera_offset(run->camera));
  if (!truth) return truth.status();
  const Result<CoarseModel> model = read_coarse_model(arguments.model_path);
  if (!model) return model.status();
  if (Status status = check_coarse_map(model->info, run->map->info().map_id); !status) return status.with_context(arguments.model_path);
  Result<CoarseNetwork> network = CoarseNetwork::load(*model, run->camera);
  if (!network) return network.status().with_context(arguments.model_path);

  CoarseEvaluation evaluation(*run->map, run->camera, std::move(*network));
  TerminalObserver observer;
  std::uint64_t num_done = 0;
  const auto on_frame = [&](const Frame& frame) {
    if (const auto T_map_camera = pose_at(truth->poses, frame.stamp_ns)) evaluation.add(frame, *T_map_camera);
    observer.show("frame", ++num_done, run->source->info().num_frames.value_or(0), "");
  };
  const auto counts = read_perturbed_frames(*run, on_frame, observer);
  observer.show("", 0, 0, "");
  if (!counts) return counts.status();
  if (InterruptGuard::is_interrupted()) return {ErrorCode::kIo, "interrupted after " + std::to_string(counts->num_frames) + " frames"};
  warn_of_corrupt_frames("camloc", *counts);
  const CoarseReport report = evaluation.report();
  if (report.num_frames == 0)
    return {ErrorCode::kInvalid, reference + ": has no pose at the times of the frames: nothing can be judged by it"};
  arguments.is_json ? print_json(report) : print_table(report);
  return Status::ok();
}

}  // namespace

void add_coarse_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<CoarseArguments>();
  CLI::App* command = app.add_subcommand("coarse", "Look at a coarse model, a network that says roughly where a camera is");
  command->require_subcommand(1);
  CLI::App* info = command->add_subcommand("info", "What a coarse model is for");
  info->add_option("FILE", arguments->model_path, "Coarse model (.onnx)")->required();
  info->add_flag("--json", arguments->is_json, "Print JSON");
  info->callback([arguments, &exit_code] { exit_code = report(show_info(*arguments)); });

  CLI::App* eval = command->add_subcommand("eval", "How far off it is, beside retrieval by words and both together");
  eval->add_option("FILE", arguments->model_path, "Coarse model (.onnx)")->required();
  eval->add_option("--map", arguments->run.map_path, "Map (.cmap) that it was trained for")->required();
  eval->add_option("--sequence", arguments->run.sequence_url, "Folder or URL of the recording")->required();
  eval->add_option("--camera", arguments->run.camera_path, "Camera file (TOML, or YAML of kalibr, ROS, OpenCV)")->required();
  eval->add_option("--reference", arguments->reference_path,
                   "True poses in the map's frame: trajectory in TUM format, or folder of a recording with poses (default: the sequence)");
  eval->add_option("--frames", arguments->run.frames, "Frames to use: start:stop:step[,...], as Python slices (default: all)");
  eval->add_option("--perturb", arguments->run.perturbations, "Change every image first, as camloc localize does; may be repeated")
      ->allow_extra_args(false);
  eval->add_flag("--json", arguments->is_json, "Print JSON");
  eval->footer(
      "Example: camloc coarse eval kitchen.onnx --map kitchen.cmap --sequence recordings/kitchen --camera 7scenes.toml --frames 600:\n"
      "Judge it on frames that it was not trained on. Exit code: 0 done, 1 failed or interrupted, 2 wrong usage or configuration.");
  eval->callback([arguments, &exit_code] { exit_code = report(evaluate(*arguments)); });
}

}  // namespace camloc::tools
