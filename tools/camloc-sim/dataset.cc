// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/camloc-sim/dataset.h"

#include <algorithm>
#include <bit>
#include <filesystem>
#include <sstream>

#include "core/io/camera_file.h"
#include "core/io/file_bytes.h"
#include "tools/camloc-sim/building.h"
#include "tools/camloc-sim/noise.h"
#include "tools/camloc-sim/sensors.h"

namespace camloc::sim {
namespace {

namespace fs = std::filesystem;

constexpr double kLidarNoiseM = 0.002;  // sigma along the surface normal

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
      << "lidar.ply       " << summary.num_lidar_points << " points of what does not move, every " << options.lidar_step_m << " m, noise "
      << kLidarNoiseM << " m\n"
      << "camera.toml     the camera of both walks\n\n"
      << "Each walk is a TUM RGB-D folder: rgb.txt, depth.txt (5000 units per metre, registered to colour, 0 = none) and "
         "groundtruth.txt\n"
      << "(T_world_camera of the colour camera at each frame's stamp: x right, y down, z forward; world z up, metres).\n"
      << "Stamps are the middle of the exposure. Depth noise: sigma(z) = " << camera.depth_noise.constant_m << " + "
      << camera.depth_noise.quadratic_per_m << " z^2 m, steps of 1/8 px disparity, 0.5 to 5 m.\n"
      << "Same options, same bytes.\n";
  return out.str();
}

std::uint64_t append_surface(const Surface& s, double step_m, const NormalTable& normal, Xorshift* random, std::string* out) {
  static_assert(std::endian::native == std::endian::little);
  const int columns = static_cast<int>(s.width / step_m), rows = static_cast<int>(s.height / step_m);
  const Eigen::Vector3d up = s.normal();
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const double u = s.width * (i + double{unit((*random)())}) / columns;
      const double v = s.height * (j + double{unit((*random)())}) / rows;
      const Eigen::Vector3d exact = s.at(u, v) + kLidarNoiseM * normal((*random)()) * up;
      const Eigen::Vector3f p = exact.cast<float>();
      out->append(reinterpret_cast<const char*>(p.data()), sizeof(float) * 3);
      const float tone = texture_tone(
          s.skin, {static_cast<float>(u) + s.texture_u, static_cast<float>(v) + s.texture_v, s.texture_width, s.texture_height, 0.01F});
      out->push_back(static_cast<char>(static_cast<std::uint8_t>(std::clamp(255.0F * tone, 0.0F, 255.0F))));
    }
  }
  return static_cast<std::uint64_t>(columns) * static_cast<std::uint64_t>(rows);
}

}  // namespace

Result<std::uint64_t> write_lidar_ply(const std::string& path, const Scene& scene, double step_m, std::uint32_t seed) {
  const NormalTable normal;
  Xorshift random(hash32(seed, 6000));
  std::string points;
  std::uint64_t count = 0;
  for (const Surface& surface : scene.surfaces) {
    if (surface.is_static) count += append_surface(surface, step_m, normal, &random, &points);
  }
  const std::string header = "ply\nformat binary_little_endian 1.0\ncomment camloc-sim, metres, world frame\nelement vertex " +
                             std::to_string(count) +
                             "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar intensity\nend_header\n";
  if (Status status = replace_file(path, header + points); !status) return status;
  return count;
}

Result<DatasetSummary> write_dataset(const std::string& folder, const DatasetOptions& options, const DatasetProgress& progress) {
  if (Status status = prepare_folder(folder, options.may_overwrite); !status) return status;
  const RgbdCamera camera = simulated_camera();
  if (Status status = replace_file(folder + "/camera.toml", format_camera_toml(camera)); !status) return status;
  const auto is_wanted = [&](const char* part) { return options.only.empty() || options.only == part; };
  DatasetSummary summary;
  for (const std::uint32_t day : {1U, 2U}) {
    const char* name = day == 1 ? "mapping" : "day2";
    if (!is_wanted(name)) continue;
    RecordingOptions recording = options.recording;
    recording.start_ns += std::int64_t{day - 1} * 86400'000000000;
    const World world = make_world({options.kind, options.seed, day});
    const auto report = [&](int done, int all) {
      if (progress) progress(name, done, all);
    };
    Result<int> frames = record(world, recording, folder + "/" + name, report);
    if (!frames) return frames.status();
    (day == 1 ? summary.num_mapping_frames : summary.num_day2_frames) = *frames;
  }
  if (is_wanted("lidar")) {
    if (progress) progress("lidar", 0, 1);
    const Scene scene = build_scene(floor_plan(options.kind, options.seed), {options.kind, options.seed, 1});
    Result<std::uint64_t> points = write_lidar_ply(folder + "/lidar.ply", scene, options.lidar_step_m, options.seed);
    if (!points) return points.status();
    summary.num_lidar_points = *points;
    if (progress) progress("lidar", 1, 1);
  }
  if (Status status = replace_file(folder + "/README.txt", readme(options, camera, summary)); !status) return status;
  return summary;
}

}  // namespace camloc::sim
