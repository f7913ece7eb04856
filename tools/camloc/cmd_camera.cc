// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// `camloc camera list`, `show` and `import`: which cameras there are, what is in a camera file, a file of others as ours.
// Calibrating is the program camloc-camera.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/io/camera_file.h"
#include "core/io/file_bytes.h"
#include "core/io/text.h"
#include "drivers/sources.h"
#include "tools/camloc/commands.h"
#include "tools/common/command_line.h"
#include "tools/common/json_text.h"
#include "tools/common/text_format.h"

namespace camloc::tools {
namespace {

struct CameraArguments {
  std::string path, out_path, name, size;
  double depth_unit_m = 0;
  bool is_json = false;
};

/// Angle between the rays of two pixels, degrees.
double angle_deg(const Intrinsics& k, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const Eigen::Vector3d a = k.undistort(from).homogeneous().normalized(), b = k.undistort(to).homogeneous().normalized();
  return degrees(std::acos(std::clamp(a.dot(b), -1.0, 1.0)));
}

std::string format_intrinsics(const char* title, const Intrinsics& k) {
  std::string text = text_of("%-12s%d x %d px, fx %.3f fy %.3f cx %.3f cy %.3f px\n", title, k.width, k.height, k.fx, k.fy, k.cx, k.cy);
  const double middle_x = 0.5 * (k.width - 1), middle_y = 0.5 * (k.height - 1);
  append_text(&text, "            field of view %.1f x %.1f deg, %.1f deg from corner to corner\n",
              angle_deg(k, {-0.5, middle_y}, {k.width - 0.5, middle_y}), angle_deg(k, {middle_x, -0.5}, {middle_x, k.height - 0.5}),
              angle_deg(k, {-0.5, -0.5}, {k.width - 0.5, k.height - 0.5}));
  const auto& d = k.distortion;
  if (k.lens == LensModel::kPinhole) return text + "            no distortion\n";
  if (k.lens == LensModel::kBrownConrady)
    append_text(&text, "            brown_conrady k1 %.6g k2 %.6g p1 %.6g p2 %.6g k3 %.6g\n", d[0], d[1], d[2], d[3], d[4]);
  if (k.lens == LensModel::kRational)
    append_text(&text, "            rational k1 %.6g k2 %.6g p1 %.6g p2 %.6g k3 %.6g k4 %.6g k5 %.6g k6 %.6g\n", d[0], d[1], d[2], d[3],
                d[4], d[5], d[6], d[7]);
  if (k.lens == LensModel::kEquidistant)
    append_text(&text, "            equidistant k1 %.6g k2 %.6g k3 %.6g k4 %.6g\n", d[0], d[1], d[2], d[3]);
  double most_px = 0;
  bool is_invertible = true;
  for (const double x : {0.0, k.width - 1.0}) {
    for (const double y : {0.0, k.height - 1.0}) {
      const Eigen::Vector2d ray = k.undistort({x, y});
      most_px = std::max(most_px, (Eigen::Vector2d(k.fx * ray.x() + k.cx, k.fy * ray.y() + k.cy) - Eigen::Vector2d(x, y)).norm());
      is_invertible = is_invertible && k.is_invertible_at({x, y});
    }
  }
  append_text(&text, "            moves the corners of the image by up to %.1f px%s\n", most_px,
              is_invertible ? "" : "; NOT INVERTIBLE in a corner: calibrate again");
  return text;
}

std::string format_depth(const RgbdCamera& camera) {
  std::string text = text_of("depth       %s, %g m a unit, used from %.2f to %.2f m\n",
                             camera.is_depth_registered ? "registered to colour" : "in its own pixels", camera.depth_unit_m,
                             camera.min_depth_m, camera.max_depth_m);
  append_text(&text, "            noise");
  for (const double z_m : {1.0, 2.0, 4.0})
    append_text(&text, " %.1f mm at %.0f m%s", 1e3 * camera.depth_noise.sigma_m(z_m), z_m, z_m < 4 ? "," : "\n");
  if (camera.is_depth_registered) return text;
  text += format_intrinsics("depth lens", camera.depth);
  const Eigen::Vector3d t = 1e3 * camera.T_color_depth.translation, r = log_so3(camera.T_color_depth.rotation);
  append_text(&text, "            at %.1f %.1f %.1f mm of the colour camera, turned by %.2f %.2f %.2f deg\n", t.x(), t.y(), t.z(),
              degrees(r.x()), degrees(r.y()), degrees(r.z()));
  return text;
}

Result<CameraHints> hints_of(const CameraArguments& arguments, std::vector<std::string>* notes) {
  CameraHints hints{0, 0, notes};
  if (arguments.size.empty()) return hints;
  const std::vector<std::string_view> sides = split_fields(arguments.size, "x");
  const auto width = sides.size() == 2 ? parse_int(sides[0]) : std::nullopt,
             height = sides.size() == 2 ? parse_int(sides[1]) : std::nullopt;
  if (!width || !height || *width < 1 || *width > 16384 || *height < 1 || *height > 16384) {
    return Status(ErrorCode::kInvalid, "--size " + in_quotes(arguments.size) + ": expected WIDTHxHEIGHT, as 640x480");
  }
  hints.width = static_cast<int>(*width), hints.height = static_cast<int>(*height);
  return hints;
}

Status show(const CameraArguments& arguments) {
  std::vector<std::string> notes;
  const auto hints = hints_of(arguments, &notes);
  if (!hints) return hints.status();
  const Result<RgbdCamera> camera = read_camera_file(arguments.path, *hints);
  if (!camera) return camera.status();
  std::printf("camera      %s\n%s%s", printable(camera->name).c_str(), format_intrinsics("colour", camera->color).c_str(),
              format_depth(*camera).c_str());
  if (camera->poses_are_of_depth_camera) std::printf("poses       recorded ones belong to the depth camera\n");
  for (const std::string& note : notes) std::printf("note        %s\n", printable(note).c_str());
  return Status::ok();
}

Status import(const CameraArguments& arguments) {
  if (Status status = check_outputs({{"--out", arguments.out_path}}, {{"the file to import", arguments.path}}); !status) return status;
  std::vector<std::string> notes;
  const auto hints = hints_of(arguments, &notes);
  if (!hints) return hints.status();
  Result<RgbdCamera> camera = read_camera_file(arguments.path, *hints);
  if (!camera) return camera.status();
  if (!arguments.name.empty()) camera->name = arguments.name;
  if (arguments.depth_unit_m > 0) camera->depth_unit_m = arguments.depth_unit_m;
  if (Status status = replace_file(arguments.out_path, format_camera_toml(*camera, notes)); !status) return status;
  for (const std::string& note : notes) std::printf("note: %s\n", note.c_str());
  std::printf("%s: written; 'camloc camera show %s' shows it\n", arguments.out_path.c_str(), arguments.out_path.c_str());
  return Status::ok();
}

Status list(const CameraArguments& arguments) {
  nlohmann::ordered_json document{{"cameras", nlohmann::ordered_json::array()}};
  std::string table;
  for (const SourceEntry& source : frame_sources()) {
    if (source.list == nullptr) continue;
    const CameraListing listing = source.list({});
    for (const FoundCamera& camera : listing.cameras) {
      document["cameras"].push_back({{"url", camera.url}, {"name", camera.name}, {"where", camera.where}, {"problem", camera.problem}});
      append_text(&table, "%-32s %s (%s)%s%s\n", camera.url.c_str(), camera.name.c_str(), camera.where.c_str(),
                  camera.problem.empty() ? "" : ": ", camera.problem.c_str());
    }
    document[std::string(source.scheme) + "_problem"] = listing.problem;
    if (!listing.problem.empty()) append_text(&table, "%-32s %s\n", (std::string(source.scheme) + "://").c_str(), listing.problem.c_str());
  }
  static_cast<void>(print_text(arguments.is_json ? json_text(document, 1) : table));
  if (!document["cameras"].empty()) return Status::ok();
  return {ErrorCode::kUnavailable, "no camera found; is it plugged in and powered? 'camloc doctor' looks closer"};
}

}  // namespace

void add_camera_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<CameraArguments>();
  CLI::App* command = app.add_subcommand("camera", "Cameras and their calibration files; calibrate one with the program camloc-camera");
  command->require_subcommand(1);
  CLI::App* list_command = command->add_subcommand("list", "Cameras that are plugged in, by the URL of each");
  list_command->add_flag("--json", arguments->is_json, "one JSON document");
  list_command->callback([arguments, &exit_code] { exit_code = report(list(*arguments)); });
  CLI::App* show_command = command->add_subcommand("show", "What a camera file says, in a table");
  show_command
      ->add_option("FILE", arguments->path,
                   "Camera file: TOML of camloc; YAML of kalibr, ROS, OpenCV, ORB-SLAM; XML of OpenCV; JSON of Open3D and SDKs; "
                   "cameras.txt of COLMAP")
      ->required();
  show_command->callback([arguments, &exit_code] { exit_code = report(show(*arguments)); });
  CLI::App* import_command =
      command->add_subcommand("import", "Write the calibration of another program (see show) as camera file of camloc");
  import_command->add_option("FILE", arguments->path, "Calibration to read")->required();
  import_command->add_option("--out", arguments->out_path, "Camera file to write")->required();
  import_command->add_option("--name", arguments->name, "Name of the camera");
  import_command
      ->add_option("--depth-unit", arguments->depth_unit_m,
                   "Metres a unit of the depth image, which these files do not say (default 0.001)")
      ->check(CLI::Range(1e-5, 0.1));
  for (CLI::App* reading : {show_command, import_command}) {
    reading->add_option("--size", arguments->size, "Size of the images, WIDTHxHEIGHT, for files that do not say it");
  }
  import_command->callback([arguments, &exit_code] { exit_code = report(import(*arguments)); });
}

}  // namespace camloc::tools
