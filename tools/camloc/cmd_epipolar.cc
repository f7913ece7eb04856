// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// `camloc epipolar`: a trajectory against the images it is of, where there is no reference, or none to be trusted.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "core/base/order_statistics.h"
#include "core/io/camera_file.h"
#include "drivers/sources.h"
#include "tools/camloc/commands.h"
#include "tools/common/frame_reading.h"
#include "tools/common/terminal_observer.h"
#include "tools/common/trajectory_file.h"
#include "tools/evaluation/epipolar_error.h"
#include "tools/evaluation/trajectory_error.h"

namespace camloc::tools {
namespace {

struct EpipolarArguments {
  std::string estimate_path, mapped_path, mapped_frames, sequence_path, camera_path;
  std::size_t num_partners = 3;
  double min_gap_s = 0.5;
  bool is_json = false;
};

/// Frames by their time of capture; those without features yet only have a pose.
using Frames = std::map<std::int64_t, FrameFeatures>;

struct FramePair {
  std::int64_t estimated_ns, mapped_ns;
};

/// What the poses are compared with: a file, the poses of a recording, or the estimate itself.
Result<EstimatedTrajectory> read_mapped(const EpipolarArguments& arguments, const RgbdCamera& camera) {
  const std::string& path = arguments.mapped_path.empty() ? arguments.estimate_path : arguments.mapped_path;
  if (!std::filesystem::is_directory(path)) return read_trajectory(path);
  auto recorded = read_recorded_poses(arguments.mapped_path, arguments.mapped_frames, depth_camera_offset(camera));
  if (!recorded) return recorded.status();
  EstimatedTrajectory trajectory;
  for (const StampedPose& pose : recorded->poses) trajectory.poses.push_back({pose.stamp_ns, pose.T_world_camera, std::nullopt});
  return trajectory;
}

/// Each pose of the estimate with the mapped ones that see most of the same.
std::vector<FramePair> pair_frames(const EstimatedTrajectory& estimate, const EstimatedTrajectory& mapped,
                                   const EpipolarArguments& arguments) {
  const auto min_gap_ns = static_cast<std::int64_t>(1e9 * arguments.min_gap_s);
  std::vector<Rigid3> poses;
  for (const EstimatedPose& pose : mapped.poses) poses.push_back(pose.T_map_camera);
  std::vector<FramePair> pairs;
  std::vector<bool> is_excluded(poses.size());
  for (const EstimatedPose& pose : estimate.poses) {
    for (std::size_t i = 0; i < poses.size(); ++i) is_excluded[i] = std::abs(mapped.poses[i].stamp_ns - pose.stamp_ns) < min_gap_ns;
    for (const std::size_t i : most_similar_views(pose.T_map_camera, poses, is_excluded, arguments.num_partners)) {
      pairs.push_back({pose.stamp_ns, mapped.poses[i].stamp_ns});
    }
  }
  return pairs;
}

void add_poses(const EstimatedTrajectory& trajectory, Frames* frames) {
  for (const EstimatedPose& pose : trajectory.poses) {
    FrameFeatures& features = (*frames)[pose.stamp_ns];
    features.stamp_ns = pose.stamp_ns;
    features.T_map_camera = pose.T_map_camera;
  }
}

/// The frames of the recording that a pair needs, as a selection; kInvalid where a pose is of no frame.
Result<std::string> frames_of(const std::vector<FramePair>& pairs, const EpipolarArguments& arguments) {
  auto sequence = read_sequence(arguments.sequence_path);
  if (!sequence) return sequence.status();
  std::set<std::int64_t> wanted_ns;
  for (const FramePair& pair : pairs) wanted_ns.insert({pair.estimated_ns, pair.mapped_ns});
  const std::size_t num_wanted = wanted_ns.size();
  std::set<std::uint64_t> frames;
  for (std::size_t i = 0; i < sequence->frames.size(); ++i) {
    if (wanted_ns.erase(sequence->frames[i].stamp_ns) > 0) frames.insert(i);
  }
  if (wanted_ns.empty()) return selection_of(frames);
  return Status(ErrorCode::kInvalid, arguments.sequence_path + ": has no frame at the times of " + std::to_string(wanted_ns.size()) +
                                         " of " + std::to_string(num_wanted) + " poses: is it the recording that the trajectories are of?");
}

Status extract_features(const std::string& selection, const EpipolarArguments& arguments, const RgbdCamera& camera, const OrbOptions& orb,
                        Frames* frames) {
  auto source = open_frame_source(with_selection(arguments.sequence_path, selection));
  if (!source) return source.status();
  FrameExtractor extractor(camera, orb);
  const std::uint64_t num_frames = source.value()->info().num_frames.value_or(0);
  TerminalObserver observer;
  std::uint64_t num_read = 0;
  const auto extract = [&](FrameBuffer& buffer) {
    const Frame frame = buffer.view();
    if (Status check = extractor.check(frame); !check) return check;
    FrameFeatures& features = (*frames)[frame.stamp_ns];
    const Rigid3 T_map_camera = features.T_map_camera;
    extractor.extract(frame, &features);
    features.T_map_camera = T_map_camera;
    observer.show("frame", ++num_read, num_frames, "");
    return Status::ok();
  };
  const auto counts = read_frames(*source.value(), extract, observer);
  if (!counts) return counts.status();
  if (observer.should_stop()) return {ErrorCode::kUnavailable, "interrupted"};
  return counts->are_all_corrupt() ? all_frames_corrupt(*counts) : Status::ok();
}

struct Agreement {
  std::size_t num_pairs = 0, num_poses = 0;  ///< image pairs that share enough, and poses of the estimate with one
  double median_px = 0, p90_px = 0;          ///< of the pairs' medians
};

Agreement measure(const std::vector<FramePair>& pairs, const Frames& frames, EpipolarMeter* meter) {
  std::vector<double> errors_px;
  Agreement agreement;
  std::int64_t last_ns = -1;
  for (const FramePair& pair : pairs) {
    const auto error = meter->measure(frames.at(pair.mapped_ns), frames.at(pair.estimated_ns));
    if (!error) continue;
    errors_px.push_back(error->median_px);
    if (pair.estimated_ns != last_ns) ++agreement.num_poses;
    last_ns = pair.estimated_ns;
  }
  agreement.num_pairs = errors_px.size();
  agreement.median_px = upper_median(errors_px);
  agreement.p90_px = lower_quantile(std::move(errors_px), 0.9);
  return agreement;
}

void print(const Agreement& agreement, std::size_t num_poses, bool is_json) {
  if (is_json) {
    const nlohmann::ordered_json json{{"poses", num_poses},
                                      {"poses_compared", agreement.num_poses},
                                      {"image_pairs", agreement.num_pairs},
                                      {"epipolar_error_px", {{"median", agreement.median_px}, {"p90", agreement.p90_px}}}};
    std::printf("%s\n", json.dump(1).c_str());
    return;
  }
  std::printf("poses           %zu, %zu of them share enough with another image\n", num_poses, agreement.num_poses);
  std::printf("image pairs     %zu\n", agreement.num_pairs);
  std::printf("epipolar error  median %.2f px, 90 %% below %.2f px (of the pairs' medians)\n", agreement.median_px, agreement.p90_px);
}

Status nothing_in_common(const EpipolarArguments& arguments) {
  return {ErrorCode::kNotFound,
          arguments.estimate_path + ": no two images of these poses see the same things; give --mapped a walk through the same place"};
}

Status epipolar(const EpipolarArguments& arguments) {
  auto camera = read_camera_file(arguments.camera_path);
  if (!camera) return camera.status();
  auto estimate = read_trajectory(arguments.estimate_path);
  if (!estimate) return estimate.status();
  auto mapped = read_mapped(arguments, *camera);
  if (!mapped) return mapped.status();
  const std::vector<FramePair> pairs = pair_frames(*estimate, *mapped, arguments);
  if (pairs.empty()) return nothing_in_common(arguments);
  const auto selection = frames_of(pairs, arguments);
  if (!selection) return selection.status();

  Frames frames;
  add_poses(*mapped, &frames);
  add_poses(*estimate, &frames);
  const OrbOptions orb;
  if (Status status = extract_features(selection.value(), arguments, *camera, orb, &frames); !status) return status;
  EpipolarMeter meter(camera->color, orb);
  const Agreement agreement = measure(pairs, frames, &meter);
  if (agreement.num_pairs == 0) return nothing_in_common(arguments);
  print(agreement, estimate->poses.size(), arguments.is_json);
  return Status::ok();
}

}  // namespace

void add_epipolar_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<EpipolarArguments>();
  CLI::App* command = app.add_subcommand("epipolar", "Compare a trajectory with the images it is of, without a reference");
  command->add_option("--estimate", arguments->estimate_path, "Trajectory in TUM format")->required();
  command->add_option("--sequence", arguments->sequence_path, "Folder of the recording that the trajectories are of")->required();
  command->add_option("--camera", arguments->camera_path, "Calibration: our TOML, or YAML of kalibr, ROS, OpenCV")->required();
  CLI::Option* mapped =
      command->add_option("--mapped", arguments->mapped_path,
                          "Another trajectory in the same map and recording, e.g. the one that the map build wrote, or a folder "
                          "with poses: each pose is compared with the most similar of these (default: with others of the estimate)");
  command->add_option("--mapped-frames", arguments->mapped_frames, "With a folder: the frames that were mapped, start:stop:step[,...]")
      ->needs(mapped);
  command->add_option("--partners", arguments->num_partners, "Images that each is compared with")
      ->check(CLI::Range(1, 20))
      ->capture_default_str();
  command->add_option("--min-gap-s", arguments->min_gap_s, "Least time between two images that are compared, seconds")
      ->check(CLI::Range(0.0, 3600.0))
      ->capture_default_str();
  command->add_flag("--json", arguments->is_json, "Print JSON");
  command->footer(
      "Example: camloc epipolar --estimate traj.tum --mapped walk.tum --sequence recordings/kitchen --camera camera.toml\n"
      "Right poses leave what the features are off by, some tenths of a pixel.\n"
      "Exit code: 0 done (however large the errors are), 1 failed, 2 wrong usage or configuration.");
  command->callback([arguments, &exit_code] { exit_code = report(epipolar(*arguments)); });
}

}  // namespace camloc::tools
