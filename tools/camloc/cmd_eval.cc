// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// `camloc eval`: a trajectory against a reference.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/io/camera_file.h"
#include "core/map/map_view.h"
#include "tools/camloc/commands.h"
#include "tools/camloc/eval_risk.h"
#include "tools/common/command_line.h"
#include "tools/common/text_format.h"
#include "tools/evaluation/risk_chart.h"
#include "tools/evaluation/top_view.h"
#include "tools/evaluation/trajectory_error.h"

namespace camloc::tools {
namespace {

struct EvalArguments {
  std::string estimate_path, reference_path, align = "none", align_by_path, align_reference_path, frames, camera_path, map_path, png_path;
  RiskArguments risk;
  bool is_json = false;
};

Result<RecordedPoses> read_reference(const EvalArguments& arguments, const std::string& path, const std::string& frames,
                                     const EstimatedTrajectory& estimate) {
  std::optional<Rigid3> T_color_depth = estimate.T_color_depth;
  if (!arguments.camera_path.empty() && std::filesystem::is_directory(path)) {
    auto camera = read_camera_file(arguments.camera_path);
    if (!camera) return camera.status();
    T_color_depth = depth_camera_offset(*camera);
  }
  return read_recorded_poses(path, frames, T_color_depth);
}

Json statistics_json(const ErrorStatistics& s) {
  return {{"median", s.median}, {"mean", s.mean}, {"rmse", s.rmse}, {"p90", s.p90}, {"max", s.max}};
}

Json errors_json(const TrajectoryErrors& errors, const EstimatedTrajectory& estimate) {
  Json within;
  for (std::size_t i = 0; i < kErrorLimits.size(); ++i) within[kErrorLimits[i].name] = errors.share_within[i];
  Json json{{"frames", errors.num_frames},
            {"localized", errors.num_localized},
            {"compared", errors.num_compared},
            {"translation_m", statistics_json(errors.translation_m)},
            {"rotation_deg", statistics_json(errors.rotation_deg)},
            {"within", within},
            {"misleading", errors.num_misleading},
            {"misleading_share",
             errors.num_frames == 0 ? 0.0 : static_cast<double>(errors.num_misleading) / static_cast<double>(errors.num_frames)},
            {"nees", nullptr},
            {"inside_95", nullptr},
            {"calibration_suspect", estimate.suspect_focal_scale.has_value()}};
  if (errors.num_with_covariance > 0) {
    json["nees"] = {{"mean", errors.nees_mean}, {"median", errors.nees_median}};
    json["inside_95"] = errors.share_inside_95;
  }
  return json;
}

void print_errors(const TrajectoryErrors& errors, const EstimatedTrajectory& estimate) {
  const auto percent = [](double share) { return 100.0 * share; };
  std::printf("frames        %llu, localized %llu (%.1f %%), compared %llu\n", llu(errors.num_frames), llu(errors.num_localized),
              errors.num_frames == 0 ? 0.0 : percent(static_cast<double>(errors.num_localized) / static_cast<double>(errors.num_frames)),
              llu(errors.num_compared));
  std::printf("              %10s %10s %10s %10s %10s\n", "median", "mean", "rmse", "p90", "max");
  const auto row = [](const char* name, const ErrorStatistics& s) {
    std::printf("%-13s %10.4f %10.4f %10.4f %10.4f %10.4f\n", name, s.median, s.mean, s.rmse, s.p90, s.max);
  };
  row("translation m", errors.translation_m);
  row("rotation deg", errors.rotation_deg);
  for (std::size_t i = 0; i < kErrorLimits.size(); ++i)
    std::printf("within %-12s %6.1f %% of all frames\n", kErrorLimits[i].name, percent(errors.share_within[i]));
  std::printf("misleading    %llu (localized, but farther off than 25 cm or 10 deg)\n", llu(errors.num_misleading));
  if (errors.num_with_covariance > 0) {
    std::printf("covariance    NEES mean %.2f median %.2f (honest: 6, 5.35), %.1f %% inside the 95 %% ellipsoid\n", errors.nees_mean,
                errors.nees_median, percent(errors.share_inside_95));
  }
  if (estimate.suspect_focal_scale)
    std::printf("WARNING       calibration: focal length should be %.3f times the one used\n", *estimate.suspect_focal_scale);
}

Status draw(const EvalArguments& arguments, const EstimatedTrajectory& estimate, const RecordedPoses& reference,
            const TrajectoryErrors& errors) {
  std::optional<MapView> map;
  if (!arguments.map_path.empty()) {
    auto opened = MapView::open(arguments.map_path);
    if (!opened) return opened.status();
    map.emplace(std::move(opened).value());
  }
  TopView view;
  view.map = map ? &*map : nullptr;
  for (const StampedPose& pose : reference.poses) view.truth.push_back(pose.T_world_camera);
  for (const EstimatedPose& pose : estimate.poses) {
    const Rigid3 T = errors.T_reference_estimate ? *errors.T_reference_estimate * pose.T_map_camera : pose.T_map_camera;
    const auto truth = pose_at(reference.poses, pose.stamp_ns);
    view.estimate.push_back(T);
    view.error_m.push_back(truth ? (truth->translation - T.translation).norm() : 0.0);
  }
  view.title = text_of("%llu of %llu frames localized, median %.1f cm / %.2f deg, %llu misleading", llu(errors.num_localized),
                       llu(errors.num_frames), 100.0 * errors.translation_m.median, errors.rotation_deg.median, llu(errors.num_misleading));
  return write_top_view(view, arguments.png_path);
}

ReferencePose lookup(const RecordedPoses& reference) {
  return [&reference](std::int64_t stamp_ns) { return pose_at(reference.poses, stamp_ns); };
}

/// The motion to apply to the estimate, by itself or by another trajectory in the same frame.
Result<std::optional<Rigid3>> find_alignment(const EvalArguments& arguments, const EstimatedTrajectory& estimate,
                                             const RecordedPoses& reference) {
  using Alignment = std::optional<Rigid3>;
  if (arguments.align_by_path.empty()) {
    if (arguments.align == "se3") return Alignment(align_by_positions(estimate, lookup(reference)));
    if (arguments.align == "poses") return Alignment(align_by_poses(estimate, lookup(reference)));
    return Alignment();
  }
  auto other = read_trajectory(arguments.align_by_path);
  if (!other) return other.status();
  const std::string& path = arguments.align_reference_path.empty() ? arguments.reference_path : arguments.align_reference_path;
  auto other_reference = read_reference(arguments, path, "", *other);
  if (!other_reference) return other_reference.status();
  const auto num_common = std::count_if(other->poses.begin(), other->poses.end(), [&](const EstimatedPose& pose) {
    return pose_at(other_reference->poses, pose.stamp_ns).has_value();
  });
  if (num_common < 3)
    return Status(ErrorCode::kInvalid, "--align-by " + arguments.align_by_path + ": has no poses at the times of " + path);
  return Alignment(align_by_poses(*other, lookup(*other_reference)));
}

/// Adds to `json`, or prints where there is none.
Status eval_risk(const RiskArguments& arguments, const ReferencePose& reference, const Rigid3& T_reference_estimate, Json* json) {
  const auto judged = judge_all(arguments, reference, T_reference_estimate);
  if (!judged) return judged.status();
  const RiskReport report = make_risk_report(judged->poses, judged->num_frames);
  if (!arguments.png_path.empty()) {
    if (Status status = write_risk_chart(report, arguments.png_path); !status) return status;
  }
  if (json != nullptr)
    (*json)["risk"] = risk_json(report);
  else
    print_risk(report);
  if (!arguments.is_calibrating) return Status::ok();
  const RiskFit fit = fit_risk(judged->poses);
  if (json != nullptr)
    (*json)["risk"]["calibration"] = risk_json(fit);
  else
    print_risk(fit);
  return Status::ok();
}

Status check_pictures(const EvalArguments& arguments) {
  std::vector<NamedPath> outputs;
  if (!arguments.png_path.empty()) outputs.push_back({"--png", arguments.png_path});
  if (!arguments.risk.png_path.empty()) outputs.push_back({"--risk-png", arguments.risk.png_path});
  return check_outputs(outputs, {{"--estimate", arguments.estimate_path},
                                 {"--reference", arguments.reference_path},
                                 {"--align-by", arguments.align_by_path},
                                 {"--align-reference", arguments.align_reference_path},
                                 {"--camera", arguments.camera_path},
                                 {"--map", arguments.map_path},
                                 {"--records", arguments.risk.records_path}});
}

Status eval(const EvalArguments& arguments) {
  if (Status status = check_pictures(arguments); !status) return status;
  auto estimate = read_trajectory(arguments.estimate_path);
  if (!estimate) return estimate.status();
  auto reference = read_reference(arguments, arguments.reference_path, arguments.frames, *estimate);
  if (!reference) return reference.status();
  for (const std::string& note : reference->notes) print_error("camloc", note);
  const bool is_counted = estimate->num_frames.has_value() && arguments.frames.empty();
  const std::uint64_t num_frames =
      is_counted ? *estimate->num_frames : std::max<std::uint64_t>(reference->num_frames, estimate->poses.size());
  const auto alignment = find_alignment(arguments, *estimate, *reference);
  if (!alignment) return alignment.status();
  const TrajectoryErrors errors = compare(*estimate, lookup(*reference), num_frames, alignment.value());
  if (errors.num_compared == 0 && errors.num_localized > 0) {
    return {ErrorCode::kInvalid,
            arguments.reference_path + ": has no pose at the times of " + arguments.estimate_path + ": is it of the same recording?"};
  }
  if (!arguments.png_path.empty()) {
    if (Status status = draw(arguments, *estimate, *reference, errors); !status) return status;
  }
  Json json = errors_json(errors, *estimate);
  if (!arguments.is_json) print_errors(errors, *estimate);
  if (!arguments.risk.records_path.empty()) {
    const Rigid3 T_reference_estimate = alignment.value().value_or(Rigid3{});
    Status status = eval_risk(arguments.risk, lookup(*reference), T_reference_estimate, arguments.is_json ? &json : nullptr);
    if (!status) return status;
  }
  if (arguments.is_json) std::printf("%s\n", json.dump(1).c_str());
  return Status::ok();
}

}  // namespace

void add_eval_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<EvalArguments>();
  CLI::App* command = app.add_subcommand("eval", "Compare a trajectory with a reference");
  command->add_option("--estimate", arguments->estimate_path, "Trajectory in TUM format")->required();
  command->add_option("--reference", arguments->reference_path, "Trajectory in TUM format, or folder of a recording with poses")
      ->required();
  command
      ->add_option("--align", arguments->align,
                   "none: same frame; se3: take out the rigid motion that fits positions best (absolute trajectory error); poses: "
                   "the one that fits positions and orientations")
      ->check(CLI::IsMember({"none", "se3", "poses"}))
      ->capture_default_str();
  CLI::Option* align_by =
      command->add_option("--align-by", arguments->align_by_path,
                          "Take out the motion that fits another trajectory in the same map to its reference, e.g. the one "
                          "that the map build wrote");
  command->add_option("--align-reference", arguments->align_reference_path, "Reference of --align-by (default: --reference)")
      ->needs(align_by);
  command->add_option("--frames", arguments->frames, "With a reference folder: the frames that were tried, start:stop:step[,...]");
  command->add_option("--camera", arguments->camera_path,
                      "Camera file that says whose poses the folder has (default: as noted in the estimate)");
  CLI::Option* png = command->add_option("--png", arguments->png_path, "Write a top view of map, reference and estimate");
  command->add_option("--map", arguments->map_path, "Map to draw in the picture")->needs(png);
  CLI::Option* records = command->add_option("--records", arguments->risk.records_path,
                                             "What 'camloc localize --json' wrote beside the estimate: were the promised risks and "
                                             "protection levels kept?");
  command->add_option("--risk-png", arguments->risk.png_path, "Draw that")->needs(records);
  command->add_option("--also", arguments->risk.also, "RECORDS REFERENCE of the colour camera, taken into the same report; repeatable")
      ->type_size(2)
      ->needs(records);
  command->add_flag("--calibrate", arguments->risk.is_calibrating, "Fit the tables of the risk to these records")->needs(records);
  command->add_flag("--json", arguments->is_json, "Print JSON");
  command->footer(
      "Example: camloc eval --estimate traj.tum --reference recordings/kitchen --map kitchen.cmap --png result.png\n"
      "Exit code: 0 done (however large the errors are), 1 failed, 2 wrong usage or configuration.");
  command->callback([arguments, &exit_code] { exit_code = report(eval(*arguments)); });
}

}  // namespace camloc::tools
