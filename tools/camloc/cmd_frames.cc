// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// `camloc frames`: which way the axes point, by one example that is computed here with the code that localizes.
#include <CLI/CLI.hpp>
#include <Eigen/Geometry>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <vector>

#include "core/geometry/ar_projection.h"
#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "core/io/sequence.h"
#include "tools/camloc/commands.h"
#include "tools/common/json_text.h"

namespace camloc::tools {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Axes of another convention, as columns in `camera`'s axes: p_camera = axes * p_other.
Matrix3d columns(const Vector3d& x, const Vector3d& y, const Vector3d& z) {
  Matrix3d axes;
  axes << x, y, z;
  return axes;
}

const Vector3d kRight = Vector3d::UnitX(), kDown = Vector3d::UnitY(), kForward = Vector3d::UnitZ();

/// The example: a map with z up, a camera at eye height looking along x of the map and turned 20 degrees to the left.
struct Example {
  Rigid3 T_map_camera;
  Vector3d p_map{5.0, 2.4, 1.9};
  Intrinsics intrinsics{640, 480, 525, 525, 319.5, 239.5};

  Example() {
    const double yaw_rad = 20 * std::numbers::pi / 180;
    const Matrix3d R_body_camera = columns(kForward, -kRight, -kDown).transpose();  // body: x forward, y left, z up
    T_map_camera.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Vector3d::UnitZ()).toRotationMatrix() * R_body_camera);
    T_map_camera.translation = {2.0, 1.0, 1.6};
  }
};

struct Convention {
  const char* name;
  const char* axes;
  Matrix3d camera_from_other;
};

std::vector<Convention> conventions() {
  return {
      {"OpenCV, ROS optical, camloc", "x right, y down, z forward", columns(kRight, kDown, kForward)},
      {"ROS body (REP-103)", "x forward, y left, z up", columns(kForward, -kRight, -kDown)},
      {"OpenGL, ARKit, WebXR eye", "x right, y up, z backward", columns(kRight, -kDown, -kForward)},
      {"Unity, Irrlicht", "x right, y up, z forward", columns(kRight, -kDown, kForward)},
      {"Unreal", "x forward, y right, z up", columns(kForward, kRight, -kDown)},
  };
}

void print_vector(const char* name, const Vector3d& v) { std::printf("  %-32s = [%+.4f %+.4f %+.4f]\n", name, v.x(), v.y(), v.z()); }

void print_matrix(const char* name, const Eigen::Matrix4d& matrix) {
  for (int row = 0; row < 4; ++row) {
    std::printf("  %-32s %s [%+.4f %+.4f %+.4f %+.4f]\n", row == 0 ? name : "", row == 0 ? "=" : " ", matrix(row, 0), matrix(row, 1),
                matrix(row, 2), matrix(row, 3));
  }
}

void print_transforms(const Example& example) {
  const Rigid3& T_map_camera = example.T_map_camera;
  const Eigen::Quaterniond& q = T_map_camera.rotation;
  std::printf(
      "T_a_b is defined by p_a = T_a_b * p_b. T_map_camera is the camera's pose in the map; its translation is the camera "
      "centre.\n\n");
  std::printf("Example: a map with z up; a camera 1.6 m above the floor that looks along x of the map, turned 20 deg to the left.\n");
  print_matrix("T_map_camera", T_map_camera.matrix());
  print_matrix("T_camera_map (the \"view matrix\")", T_map_camera.inverse().matrix());
  std::printf("  %-32s = [%+.4f %+.4f %+.4f %+.4f]   LCM (pose_t, bot_core), Eigen's constructor, COLMAP\n", "rotation as w x y z", q.w(),
              q.x(), q.y(), q.z());
  std::printf("  %-32s = [%+.4f %+.4f %+.4f %+.4f]   TUM files, ROS messages\n", "rotation as x y z w", q.x(), q.y(), q.z(), q.w());
  std::printf("  %-32s = %s\n\n", "TUM line at t = 1 s", format_tum_line(1'000'000'000, T_map_camera).c_str());
}

void print_projection(const Example& example) {
  const Vector3d p_camera = example.T_map_camera.inverse() * example.p_map;
  const Eigen::Vector2d pixel = example.intrinsics.project(p_camera);
  std::printf("A point of the map, seen by that camera (fx = fy = 525, cx = 319.5, cy = 239.5, pixel centres at integers):\n");
  print_vector("p_map", example.p_map);
  print_vector("p_camera = T_camera_map * p_map", p_camera);
  print_vector("T_map_camera * p_camera", example.T_map_camera * p_camera);
  std::printf("  %-32s = %.2f + %.0f * %+.4f / %.4f = %.2f   (column, to the right)\n", "u = cx + fx * x / z", example.intrinsics.cx,
              example.intrinsics.fx, p_camera.x(), p_camera.z(), pixel.x());
  std::printf("  %-32s = %.2f + %.0f * %+.4f / %.4f = %.2f   (row, downwards)\n\n", "v = cy + fy * y / z", example.intrinsics.cy,
              example.intrinsics.fy, p_camera.y(), p_camera.z(), pixel.y());

  std::printf("The same point in the camera axes of others:\n");
  for (const auto& convention : conventions()) {
    const Vector3d p = convention.camera_from_other.transpose() * p_camera;
    std::printf("  %-28s %-27s %-13s [%+.4f %+.4f %+.4f] m\n", convention.name, convention.axes,
                convention.camera_from_other.determinant() > 0 ? "right-handed" : "LEFT-handed", p.x(), p.y(), p.z());
  }
  std::printf("  Unreal counts in centimetres. A left-handed convention is a mirror image: no rotation leads there.\n\n");
}

void print_covariance(const Example& example) {
  const Rigid3 estimate{exp_so3({0, 0, 0.01}) * example.T_map_camera.rotation, example.T_map_camera.translation + Vector3d(0.02, 0, 0)};
  const Vector6d error = pose_error(example.T_map_camera, estimate);
  std::printf(
      "Covariance: 6x6, first position (m), then rotation vector (rad), both in the axes of the map. An estimate 2 cm too far "
      "along\n"
      "x and turned 0.01 rad too far about the map's z has the error\n");
  std::printf("  %-32s = [%+.4f %+.4f %+.4f  %+.4f %+.4f %+.4f]\n", "pose_error(true, estimate)", error[0], error[1], error[2], error[3],
              error[4], error[5]);
}

/// The example as an engine draws it: its own matrices, and the pixel that comes out of them.
struct DrawnExample {
  VirtualCamera camera;
  Vector3d p_world;
  DrawnPoint drawn;

  DrawnExample(const EngineConvention& engine, const Example& example)
      : camera(virtual_camera(engine, example.intrinsics, example.T_map_camera, {})), p_world(engine_point(engine, example.p_map)) {
    drawn = draw_point(engine, camera, p_world, example.intrinsics.width, example.intrinsics.height).value_or(DrawnPoint{});
  }
};

void print_engines(const Example& example) {
  std::printf("The same point drawn by an engine, with the projection and view that camloc makes for it (near 0.05 m, far 100 m):\n");
  for (const EngineConvention& engine : engine_conventions()) {
    const DrawnExample of(engine, example);
    std::printf("  %-10s world %-52s p = [%+.2f %+.2f %+.2f]  pixel %.2f %.2f\n", engine.name, engine.world_axes, of.p_world.x(),
                of.p_world.y(), of.p_world.z(), of.drawn.pixel.x(), of.drawn.pixel.y());
  }
  std::printf("  `camloc frames --engine NAME` prints the matrices.\n\n");
}

void print_engine(const EngineConvention& engine, const Example& example) {
  const DrawnExample of(engine, example);
  std::printf("%s: world %s; depth %g at the near plane, %g at the far one; clip y %s.\n", engine.name, engine.world_axes, engine.z_near,
              engine.z_far, engine.is_clip_y_down ? "down" : "up");
  std::printf("Matrices that multiply columns; in memory column by column, which is also how engines keep them that multiply rows.\n");
  print_matrix("projection", of.camera.projection);
  print_matrix("view", of.camera.view);
  print_vector("p_world (units of the engine)", of.p_world);
  const Eigen::Vector4d clip = of.camera.projection * (of.camera.view * of.p_world.homogeneous());
  std::printf("  %-32s = [%+.4f %+.4f %+.4f %+.4f]\n", "clip = projection * view * p", clip.x(), clip.y(), clip.z(), clip.w());
  std::printf("  %-32s = %.2f %.2f, depth %.6f\n", "pixel", of.drawn.pixel.x(), of.drawn.pixel.y(), of.drawn.depth);
}

nlohmann::json to_json(const Eigen::Matrix4d& matrix) {
  nlohmann::json rows = nlohmann::json::array();
  for (int row = 0; row < 4; ++row) rows.push_back({matrix(row, 0), matrix(row, 1), matrix(row, 2), matrix(row, 3)});
  return rows;
}

void print_json(const Example& example) {
  const Vector3d p_camera = example.T_map_camera.inverse() * example.p_map;
  const Eigen::Vector2d pixel = example.intrinsics.project(p_camera);
  const Eigen::Quaterniond& q = example.T_map_camera.rotation;
  nlohmann::json document{{"T_map_camera", to_json(example.T_map_camera.matrix())},
                          {"T_camera_map", to_json(example.T_map_camera.inverse().matrix())},
                          {"rotation_wxyz", {q.w(), q.x(), q.y(), q.z()}},
                          {"p_map", json_of(example.p_map)},
                          {"p_camera", json_of(p_camera)},
                          {"pixel", {pixel.x(), pixel.y()}}};
  for (const auto& convention : conventions()) {
    document["conventions"][convention.name] = {{"axes", convention.axes},
                                                {"is_right_handed", convention.camera_from_other.determinant() > 0},
                                                {"p", json_of(Vector3d(convention.camera_from_other.transpose() * p_camera))}};
  }
  for (const EngineConvention& engine : engine_conventions()) {
    const DrawnExample of(engine, example);
    document["engines"][engine.name] = {
        {"world_axes", engine.world_axes}, {"projection", to_json(of.camera.projection)},       {"view", to_json(of.camera.view)},
        {"p_world", json_of(of.p_world)},  {"pixel", {of.drawn.pixel.x(), of.drawn.pixel.y()}}, {"depth", of.drawn.depth}};
  }
  std::printf("%s\n", document.dump(2).c_str());
}

void run(bool is_json, const std::string& engine) {
  const Example example;
  if (!engine.empty()) return print_engine(*find_engine(engine), example);
  if (is_json) return print_json(example);
  print_transforms(example);
  print_projection(example);
  print_engines(example);
  print_covariance(example);
}

}  // namespace

void add_frames_command(CLI::App& app, int& /*exit_code*/) {
  auto is_json = std::make_shared<bool>(false);
  CLI::App* command = app.add_subcommand("frames", "Frame conventions with a worked example");
  command->add_flag("--json", *is_json, "the numbers as JSON");
  auto engine = std::make_shared<std::string>();
  std::vector<std::string> names;
  for (const EngineConvention& of : engine_conventions()) names.emplace_back(of.name);
  command->add_option("--engine", *engine, "The matrices of one engine")->check(CLI::IsMember(names));
  command->callback([is_json, engine] { run(*is_json, *engine); });
}

}  // namespace camloc::tools
