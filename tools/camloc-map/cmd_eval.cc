// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// camloc-map eval: a map against a laser scan, or against the depth images of a recording with trusted poses.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>

#include "core/io/camera_file.h"
#include "core/io/file_bytes.h"
#include "core/io/image_writer.h"
#include "core/io/sequence.h"
#include "tools/camloc-map/commands.h"
#include "tools/common/named_choice.h"
#include "tools/common/terminal_observer.h"
#include "tools/mapping/build/posed_frames.h"
#include "tools/mapping/cloud/point_cloud.h"
#include "tools/mapping/eval/evaluation.h"

namespace camloc::mapping {
namespace {

constexpr const char* kFooter =
    "Examples: against a scan; against the recording's own depth with poses from elsewhere\n"
    "  camloc-map eval building.cmap --lidar scan.ply --points control.txt --out-dir report\n"
    "  camloc-map eval kitchen.cmap --reference-sequence data/kitchen --camera config/cameras/7scenes.toml \\\n"
    "      --trajectory kitchen.tum\n"
    "Distances are given both ways, with coverage and scale: each alone can look perfect for a wrong map.\n"
    "Exit code: 0 done (warnings are in the report), 1 failed, 2 wrong usage or configuration.";

struct EvalArguments {
  std::string map_path, lidar_path, points_path, trajectory_path, reference_trajectory_path, camera_path, out_dir;
  PosedFramesRequest reference;
  std::uint64_t frame_step = 5;
  std::optional<double> lidar_unit_m;
  double voxel_m = 0.01;
  EvaluationOptions options;
  bool is_json = false;
};

/// The camera in the map and in the frame of the cloud at the same times: those of the trajectory of the map.
Result<std::vector<PosePair>> match_poses(const std::string& trajectory_path, const std::vector<StampedPose>& reference) {
  const auto trajectory = read_tum_trajectory(trajectory_path);
  if (!trajectory.is_ok()) return trajectory.status();
  std::vector<PosePair> pairs;
  for (const StampedPose& pose : trajectory.value()) {
    if (const auto T_reference_camera = pose_at(reference, pose.stamp_ns)) pairs.push_back({pose.T_world_camera, *T_reference_camera});
  }
  if (pairs.size() >= 3) return pairs;
  return {ErrorCode::kInvalid, trajectory_path + ": only " + std::to_string(pairs.size()) + " of its " +
                                   std::to_string(trajectory.value().size()) +
                                   " poses are at the time of a reference pose; is it of this recording?"};
}

/// The colour camera's reference poses of a recording, in time.
Result<std::vector<StampedPose>> stamped(const PosedFrames& frames) {
  const auto sequence = read_sequence(frames.folder);
  if (!sequence.is_ok()) return sequence.status();
  std::vector<StampedPose> poses;
  for (const auto& [index, T_map_camera] : frames.T_map_camera_of_frame)
    poses.push_back({sequence.value().frames[index].stamp_ns, T_map_camera});
  return poses;
}

/// The dense cloud, and with --trajectory the pairs of poses.
Result<PointCloud> load_reference(EvalArguments arguments, std::vector<PosePair>* poses, WorkObserver& observer) {
  const auto camera = read_camera_file(arguments.camera_path);
  if (!camera.is_ok()) return camera.status();
  const auto all_frames = find_posed_frames(arguments.reference, camera.value());
  if (!all_frames.is_ok()) return all_frames.status();
  if (!arguments.trajectory_path.empty()) {
    const auto reference = stamped(all_frames.value());
    if (!reference.is_ok()) return reference.status();
    auto pairs = match_poses(arguments.trajectory_path, reference.value());
    if (!pairs.is_ok()) return pairs.status();
    *poses = std::move(pairs).value();
  }
  arguments.reference.include = "::" + std::to_string(arguments.frame_step);
  const auto frames = find_posed_frames(arguments.reference, camera.value());
  if (!frames.is_ok()) return frames.status();
  return fuse_dense_cloud(frames.value(), camera.value(), arguments.voxel_m, observer);
}

Status write_files(const EvalArguments& arguments, const PointCloud& cloud, EvalSummary* summary) {
  if (arguments.out_dir.empty()) return Status::ok();
  const std::filesystem::path folder(arguments.out_dir);
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return {ErrorCode::kIo, "--out-dir " + arguments.out_dir + ": " + error.message()};
  const std::string title = std::filesystem::path(arguments.map_path).filename().string() + " against " +
                            std::filesystem::path(summary->cloud_name).filename().string();
  const Evaluation& e = summary->evaluation;
  const std::pair<const char*, ColorImage> pictures[] = {
      {"histogram.png", draw_histogram(e.distances, title)},
      {"top.png", draw_cloud_view(e, cloud, CloudView::kTop, title + ", from above")},
      {"side.png", draw_cloud_view(e, cloud, CloudView::kSide, title + ", from the side")}};
  for (const auto& [name, image] : pictures) {
    const std::string path = (folder / name).string();
    if (const Status written = write_png(path, image); !written.is_ok()) return written;
    summary->files.push_back(path);
  }
  const std::string path = (folder / "evaluation.json").string();
  summary->files.push_back(path);
  return replace_file(path, format_json(*summary));
}

Status load_alignment(const EvalArguments& arguments, EvaluationInput* input) {
  if (!arguments.points_path.empty()) {
    auto points = read_point_pairs(arguments.points_path);
    if (!points.is_ok()) return points.status();
    input->points = std::move(points).value();
  }
  if (arguments.reference_trajectory_path.empty()) return Status::ok();
  const auto reference = read_tum_trajectory(arguments.reference_trajectory_path);
  if (!reference.is_ok()) return reference.status();
  auto poses = match_poses(arguments.trajectory_path, reference.value());
  if (!poses.is_ok()) return poses.status();
  input->poses = std::move(poses).value();
  return Status::ok();
}

Status evaluate(const EvalArguments& arguments, const MapView& map, EvalSummary* summary) {
  const auto start = std::chrono::steady_clock::now();
  tools::TerminalObserver observer;
  EvaluationInput input{&map, nullptr, {}, {}};
  if (const Status loaded = load_alignment(arguments, &input); !loaded.is_ok()) return loaded;
  const bool is_scan = !arguments.lidar_path.empty();
  const auto cloud = is_scan ? read_cloud(arguments.lidar_path, {arguments.voxel_m, arguments.lidar_unit_m, 1}, observer)
                             : load_reference(arguments, &input.poses, observer);
  if (!cloud.is_ok()) return cloud.status();
  input.cloud = &cloud.value();
  EvaluationOptions options = arguments.options;
  // A recording's poses are in a frame of their own: the datum of the map says nothing about it.
  if (!is_scan && options.start == AlignStart::kAuto && input.points.empty() && input.poses.empty()) options.start = AlignStart::kSearch;
  auto evaluation = evaluate_map(input, options, observer);
  if (!evaluation.is_ok()) return evaluation.status();
  if (map.is_damaged()) return {ErrorCode::kCorrupt, arguments.map_path + ": was truncated while it was read"};
  summary->evaluation = std::move(evaluation).value();
  summary->map_path = arguments.map_path;
  summary->cloud_name = is_scan ? arguments.lidar_path : arguments.reference.sequence;
  summary->num_read = cloud.value().num_read;
  summary->num_invalid = cloud.value().num_invalid;
  summary->unit_m = cloud.value().unit_m;
  summary->unit_from = is_scan ? cloud.value().unit_from : "";
  summary->cloud_notes = cloud.value().notes;
  summary->cloud_warnings = cloud.value().warnings;
  summary->num_points = cloud.value().points_m.size();
  summary->voxel_m = arguments.voxel_m;
  summary->min_observations = arguments.options.min_observations;
  observer.show("drawing ...", 0, 0, "");
  const Status written = write_files(arguments, cloud.value(), summary);
  summary->seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return written;
}

Status check(const EvalArguments& arguments) {
  if (arguments.lidar_path.empty() == arguments.reference.sequence.empty()) {
    return {ErrorCode::kInvalid, "give a cloud to compare with: either --lidar CLOUD, or --reference-sequence DIR with --camera FILE"};
  }
  if (!arguments.reference.sequence.empty() && arguments.camera_path.empty())
    return {ErrorCode::kInvalid, "--reference-sequence needs --camera FILE"};
  const bool has_reference_poses = !arguments.reference.sequence.empty() || !arguments.reference_trajectory_path.empty();
  if (!arguments.trajectory_path.empty() && !has_reference_poses) {
    return {ErrorCode::kInvalid, "--trajectory needs poses to compare it with: --reference-trajectory FILE in the frame of the scan"};
  }
  if (!arguments.reference_trajectory_path.empty() && (arguments.trajectory_path.empty() || arguments.lidar_path.empty())) {
    return {ErrorCode::kInvalid, "--reference-trajectory goes with --lidar and --trajectory"};
  }
  if (!arguments.out_dir.empty() && std::filesystem::exists(arguments.out_dir) && !std::filesystem::is_directory(arguments.out_dir)) {
    return {ErrorCode::kInvalid, "--out-dir " + arguments.out_dir + ": is a file; give a folder"};
  }
  return Status::ok();
}

/// What the user has to correct in arguments and files is 2; the rest failed.
int exit_code_of(const Status& status) {
  const ErrorCode code = status.code();
  return code == ErrorCode::kInvalid || code == ErrorCode::kCorrupt || code == ErrorCode::kUnsupported ? 2 : 1;
}

int run(const EvalArguments& arguments) {
  if (const Status checked = check(arguments); !checked.is_ok()) return report_error(checked, 2);
  const auto map = MapView::open(arguments.map_path);
  if (!map.is_ok()) return report_error(map.status(), exit_code_of(map.status()));
  EvalSummary summary;
  if (const Status done = evaluate(arguments, map.value(), &summary); !done.is_ok()) return report_error(done, exit_code_of(done));
  const std::string text = arguments.is_json ? format_json(summary) : format_table(summary);
  return tools::print_text(text) ? 0 : 1;
}

void add_reference_options(CLI::App* command, EvalArguments* arguments) {
  command->add_option("--lidar", arguments->lidar_path, "Scan to compare with: PLY, PCD, LAS, PTX, or text (XYZ, PTS, CSV)");
  const std::map<std::string, double> units{{"m", 1.0}, {"cm", 0.01}, {"mm", 0.001}, {"ft", 0.3048}, {"us-ft", 1200.0 / 3937.0}};
  command
      ->add_option("--lidar-unit", arguments->lidar_unit_m,
                   "Unit of the scan: m, cm, mm, ft, us-ft (default: what a LAS file says, else m)")
      ->transform(tools::named_choice(units));
  command->add_option("--reference-sequence", arguments->reference.sequence,
                      "Instead of a scan: recording whose depth images and poses make a dense cloud (TUM RGB-D or 7-Scenes)");
  command->add_option("--camera", arguments->camera_path, "Calibration of that recording");
  command->add_option("--poses", arguments->reference.poses, "Its poses: 'embedded' (default) or a trajectory file in TUM format");
  command->add_option("--frame-step", arguments->frame_step, "Every so many of its frames (default 5)")->check(CLI::Range(1, 100000));
}

void add_alignment_options(CLI::App* command, EvalArguments* arguments) {
  command->add_option("--points", arguments->points_path,
                      "Control points, a line each: name map_x map_y map_z cloud_x cloud_y cloud_z [sigma]");
  command->add_option("--trajectory", arguments->trajectory_path,
                      "Trajectory of the map's recording in the map's frame, TUM format: aligned with that of the reference");
  command->add_option("--reference-trajectory", arguments->reference_trajectory_path,
                      "The same recording in the frame of the scan, TUM format");
  const std::map<std::string, AlignStart> starts{
      {"auto", AlignStart::kAuto},   {"points", AlignStart::kPoints}, {"trajectory", AlignStart::kTrajectory},
      {"datum", AlignStart::kDatum}, {"none", AlignStart::kNone},     {"search", AlignStart::kSearch}};
  command
      ->add_option("--align", arguments->options.start,
                   "Where the alignment starts: points, trajectory, datum (of the map), none (frames are equal), search; auto "
                   "(default): the "
                   "first of these that is given, else search")
      ->transform(tools::named_choice(starts));
  command->add_flag("!--no-icp", arguments->options.has_icp, "Measure at the start, without fitting the surfaces");
  command->add_option("--trim", arguments->options.trim, "Share of the closest correspondences that ICP uses (default 0.9)")
      ->check(CLI::Range(0.1, 1.0));
  command
      ->add_option("--max-distance", arguments->options.max_distance_m,
                   "Farther from the cloud a landmark is outside of the scan, metres (default 0.5)")
      ->check(CLI::Range(0.01, 100.0));
  command->add_option("--voxel", arguments->voxel_m, "Thin the cloud to a point a voxel of this size, metres (default 0.01)")
      ->check(CLI::Range(0.001, 1.0));
  command->add_option("--min-observations", arguments->options.min_observations, "Landmarks seen by fewer frames are left out (default 2)");
}

}  // namespace

void add_eval_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<EvalArguments>();
  CLI::App* command = app.add_subcommand("eval", "Compares a map with a laser scan: distances both ways, coverage, scale.");
  command->footer(kFooter);
  command->add_option("map", arguments->map_path, "Map file")->required();
  add_reference_options(command, arguments.get());
  add_alignment_options(command, arguments.get());
  command->add_option("--out-dir", arguments->out_dir, "Folder for histogram.png, top.png, side.png and evaluation.json");
  command->add_flag("--json", arguments->is_json, "Print the report as JSON");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace camloc::mapping
