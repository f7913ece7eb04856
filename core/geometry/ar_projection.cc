// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/ar_projection.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace camloc {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Vector3d;

Matrix3d rows(const Vector3d& x, const Vector3d& y, const Vector3d& z) {
  Matrix3d matrix;
  matrix << x.transpose(), y.transpose(), z.transpose();
  return matrix;
}

const Vector3d kX = Vector3d::UnitX(), kY = Vector3d::UnitY(), kZ = Vector3d::UnitZ();
// The eye, in optical axes: right is x, up is -y, forward is z.
const Matrix3d kEyeLooksBackward = rows(kX, -kY, -kZ), kEyeLooksForward = rows(kX, -kY, kZ);

// Unity's own matrices follow OpenGL whatever it draws with; Unreal's projection reverses depth.
const EngineConvention kEngines[] = {
    {"opengl", "right-handed, y up: x, z, -y of the map", rows(kX, kZ, -kY), kEyeLooksBackward, 1, -1, 1, false},
    {"webxr", "right-handed, y up: x, z, -y of the map", rows(kX, kZ, -kY), kEyeLooksBackward, 1, -1, 1, false},
    {"vulkan", "right-handed, y up: x, z, -y of the map", rows(kX, kZ, -kY), kEyeLooksBackward, 1, 0, 1, true},
    {"direct3d", "left-handed, y up: x, z, y of the map", rows(kX, kZ, kY), kEyeLooksForward, 1, 0, 1, false},
    {"irrlicht", "left-handed, y up: x, z, y of the map", rows(kX, kZ, kY), kEyeLooksForward, 1, 0, 1, false},
    {"unity", "left-handed, y up: x, z, y of the map", rows(kX, kZ, kY), kEyeLooksBackward, 1, -1, 1, false},
    {"unreal", "left-handed, z up, centimetres: x, -y, z of the map", rows(kX, -kY, kZ), kEyeLooksForward, 100, 1, 0, false},
};

/// Of a point in optical axes; w is its z. The image's edges are half a pixel beyond the centres of its outer pixels.
Matrix4d optical_projection(const EngineConvention& engine, const Intrinsics& of, const ClipPlanes& planes) {
  const double near = planes.near_m * engine.units_per_m, far = planes.far_m * engine.units_per_m;
  const double sign_y = engine.is_clip_y_down ? 1 : -1;
  Matrix4d projection = Matrix4d::Zero();
  projection(0, 0) = 2 * of.fx / of.width;
  projection(0, 2) = 2 * (of.cx + 0.5) / of.width - 1;
  projection(1, 1) = sign_y * 2 * of.fy / of.height;
  projection(1, 2) = sign_y * (2 * (of.cy + 0.5) / of.height - 1);
  // (a z + b) / z is z_near at the near plane and z_far at the far one.
  projection(2, 3) = (engine.z_near - engine.z_far) * near * far / (far - near);
  projection(2, 2) = engine.z_near - projection(2, 3) / near;
  projection(3, 2) = 1;
  return projection;
}

Matrix4d of_blocks(const Matrix3d& linear, const Vector3d& offset) {
  Matrix4d matrix = Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = linear;
  matrix.topRightCorner<3, 1>() = offset;
  return matrix;
}

}  // namespace

std::span<const EngineConvention> engine_conventions() { return kEngines; }

const EngineConvention* find_engine(std::string_view name) {
  const auto at =
      std::find_if(std::begin(kEngines), std::end(kEngines), [&](const EngineConvention& engine) { return name == engine.name; });
  return at == std::end(kEngines) ? nullptr : at;
}

Vector3d engine_point(const EngineConvention& engine, const Vector3d& p_map) { return engine.units_per_m * (engine.R_world_map * p_map); }

VirtualCamera virtual_camera(const EngineConvention& engine, const Intrinsics& intrinsics, const Rigid3& T_map_camera,
                             const ClipPlanes& planes) {
  const Rigid3 T_camera_map = T_map_camera.inverse();
  // Rotations on both sides, so that lengths stay the engine's units.
  const Matrix3d R_eye_world = engine.R_eye_camera * T_camera_map.rotation.toRotationMatrix() * engine.R_world_map.transpose();
  return {optical_projection(engine, intrinsics, planes) * of_blocks(engine.R_eye_camera.transpose(), Vector3d::Zero()),
          of_blocks(R_eye_world, engine.units_per_m * (engine.R_eye_camera * T_camera_map.translation))};
}

std::array<double, 16> elements(const Matrix4d& matrix) {
  std::array<double, 16> values{};
  Eigen::Map<Eigen::Matrix<double, 4, 4, Eigen::ColMajor>>(values.data()) = matrix;
  return values;
}

std::optional<DrawnPoint> draw_point(const EngineConvention& engine, const VirtualCamera& camera, const Vector3d& p_world, int width,
                                     int height) {
  const Eigen::Vector4d clip = camera.projection * (camera.view * p_world.homogeneous());
  if (!(clip.w() > 0)) return std::nullopt;
  const Vector3d device = clip.head<3>() / clip.w();
  const double down = engine.is_clip_y_down ? device.y() : -device.y();
  return DrawnPoint{{0.5 * width * (device.x() + 1) - 0.5, 0.5 * height * (down + 1) - 0.5}, device.z()};
}

Viewport letterbox(int image_width, int image_height, int window_width, int window_height) {
  const double scale = std::min(static_cast<double>(window_width) / image_width, static_cast<double>(window_height) / image_height);
  Viewport viewport;
  viewport.width = std::min(window_width, static_cast<int>(std::lround(scale * image_width)));
  viewport.height = std::min(window_height, static_cast<int>(std::lround(scale * image_height)));
  viewport.x = (window_width - viewport.width) / 2;
  viewport.y = (window_height - viewport.height) / 2;
  return viewport;
}

UndistortionMesh undistortion_mesh(const Intrinsics& of, int columns, int rows) {
  UndistortionMesh mesh{columns, rows, {}, {}};
  const Eigen::Vector2d size(of.width, of.height), half(0.5, 0.5);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const Eigen::Vector2d texture(static_cast<double>(column) / (columns - 1), static_cast<double>(row) / (rows - 1));
      const Eigen::Vector2d ray = of.undistort(texture.cwiseProduct(size) - half);
      const Eigen::Vector2d straight(of.fx * ray.x() + of.cx, of.fy * ray.y() + of.cy);
      mesh.texture.push_back(texture);
      mesh.positions.push_back((straight + half).cwiseQuotient(size));
    }
  }
  return mesh;
}

}  // namespace camloc
