// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/camloc-sim/dataset.h"

#include <filesystem>
#include <sstream>

#include "core/io/camera_file.h"
#include "core/io/file_bytes.h"

namespace camloc::sim {
namespace {

namespace fs = std::filesystem;

/// The folder exists and holds none of our files; nothing else in it is touched.
Status prepare_folder(const std::string& folder, bool may_overwrite) {
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_directory(folder, error)) return {ErrorCode::kIo, folder + ": is not a folder"};
  fs::create_directories(folder, error);
  if (error) return {ErrorCode::kIo, folder + ": cannot create: " + error.message()};
  const bool is_empty = fs::is_empty(folder, error);
  if (error) return {ErrorCode::kIo, folder + ": cannot read: " + error.message()};
  if (is_empty) return Status::ok();
  if (!may_overwrite) return {ErrorCode::kInvalid, folder + ": is not empty; choose another folder or pass --force"};
  for (const char* part : {"mapping", "day2", "lidar.ply", "camera.toml", "README.txt"}) {
    fs::remove_all(fs::path(folder) / part, error);
    if (error) return {ErrorCode::kIo, folder + "/" + part + ": cannot remove: " + error.message()};
  }
  return Status::ok();
}

std::string readme(const DatasetOptions& options, const RgbdCamera& camera, const DatasetSummary& summary) {
  std::ostringstream out;
  out << "Synthetic RGB-D data set written by camloc-sim.\n\n"
      << "scene           "
      << (options.kind == SceneKind::kBuilding ? "building: corridor loop, nine offices" : "small: corridor corner and two offices") << "\n"
      << "seed            " << options.seed << "\n"
      << "rate            " << options.recording.rate_hz << " Hz\n"
      << "duration scale  " << options.recording.duration_scale << "\n\n"
      << "mapping/        " << summary.num_mapping_frames << " frames: the walk to build the map from\n"
      << "day2/           " << summary.num_day2_frames
      << " frames: another day: other path, heights and angles, other light (some lamps off), chairs, boxes\n"
      << "                and papers moved, people in the way, a stretch walked in the other direction\n"
      << "lidar.ply       " << summary.num_lidar_points << " points of what does not move, every " << options.lidar.step_m << " m, noise "
      << options.lidar.noise_m << " m\n"
      << "camera.toml     the camera of both walks\n\n"
      << "Each walk is a TUM RGB-D folder: rgb.txt, depth.txt (5000 units per metre, registered to colour, 0 = none) and "
         "groundtruth.txt\n"
      << "(T_world_camera of the colour camera at each frame's stamp: x right, y down, z forward; world z up, metres).\n"
      << "Stamps are the middle of the exposure. Depth noise: sigma(z) = " << camera.depth_noise.constant_m << " + "
      << camera.depth_noise.quadratic_per_m << " z^2 m, steps of 1/8 px disparity, 0.5 to 5 m.\n"
      << "Same options, same bytes.\n";
  return out.str();
}

}  // namespace

Result<DatasetSummary> write_dataset(const std::string& folder, const DatasetOptions& options, const DatasetProgress& progress) {
  if (Status status = prepare_folder(folder, options.may_overwrite); !status) return status;
  const RgbdCamera camera = simulated_camera();
  if (Status status = replace_file(folder + "/camera.toml", format_camera_toml(camera)); !status) return status;
  DatasetSummary summary;
  for (const std::uint32_t day : {1U, 2U}) {
    if (!(day == 1 ? options.has_mapping : options.has_day2)) continue;
    const std::string name = day == 1 ? "mapping" : "day2";
    RecordingOptions recording = options.recording;
    recording.start_ns += std::int64_t{day - 1} * 86400'000000000;
    const World world = make_world({options.kind, options.seed, day});
    const auto report = [&](int done, int all) {
      if (progress) progress(name, done, all);
    };
    Result<int> frames = record(world, camera, recording, folder + "/" + name, report);
    if (!frames) return frames.status();
    (day == 1 ? summary.num_mapping_frames : summary.num_day2_frames) = *frames;
  }
  if (options.has_lidar) {
    if (progress) progress("lidar", 0, 1);
    const FloorPlan plan = floor_plan(options.kind, options.seed);
    LidarOptions lidar = options.lidar;
    lidar.seed = options.seed;
    Result<std::uint64_t> points = write_lidar_ply(folder + "/lidar.ply", build_scene(plan, {options.kind, options.seed, 1}), lidar);
    if (!points) return points.status();
    summary.num_lidar_points = *points;
    if (progress) progress("lidar", 1, 1);
  }
  if (Status status = replace_file(folder + "/README.txt", readme(options, camera, summary)); !status) return status;
  return summary;
}

}  // namespace camloc::sim
