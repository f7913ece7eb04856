// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The virtual camera of an engine that draws over the image of a real one: projection and view from intrinsics and pose, in the
// conventions of that engine, exact to rounding for any principal point ("Camera localization for augmented reality and indoor
// positioning: a vision-based 3D feature database approach", 2020, eq. 5 to 13; its symmetric frustum is the special case of a principal
// point in the middle of the image). Lens distortion is no matrix: take it out of the image first, or draw the image on the mesh.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"

namespace camloc {

/// How an engine counts. The map is taken to have z up, as one that was placed in a site has; matrices here multiply columns.
struct EngineConvention {
  const char* name;              ///< "opengl", "direct3d", "vulkan", "webxr", "unity", "unreal", "irrlicht"
  const char* world_axes;        ///< for people: what x, y, z of its world are, seen from the map
  Eigen::Matrix3d R_world_map;   ///< orthonormal; a mirror image (determinant -1) for a left-handed world
  Eigen::Matrix3d R_eye_camera;  ///< from the optical axes (x right, y down, z forward) to those that its projection takes
  double units_per_m;            ///< 100 where it counts centimetres
  double z_near, z_far;          ///< depth after the division, of the near and of the far plane
  bool is_clip_y_down;
};

[[nodiscard]] std::span<const EngineConvention> engine_conventions();
/// Nothing for a name that is none of them.
[[nodiscard]] const EngineConvention* find_engine(std::string_view name);

struct ClipPlanes {
  double near_m = 0.05, far_m = 100;  ///< 0 < near < far
};

/// A point of the map is seen at clip = projection * view * world(point); x and y over w are -1 to 1 over the whole image, pixel edge to
/// pixel edge. `elements` of either is the order in which all engines here keep a matrix in memory: those that write vectors as rows
/// keep the transposed matrix row by row, which is the same 16 numbers.
struct VirtualCamera {
  Eigen::Matrix4d projection, view;
};

/// `intrinsics` without their distortion.
[[nodiscard]] VirtualCamera virtual_camera(const EngineConvention& engine, const Intrinsics& intrinsics, const Rigid3& T_map_camera,
                                           const ClipPlanes& planes);

/// A point of the map, metres, in the engine's world and units.
[[nodiscard]] Eigen::Vector3d engine_point(const EngineConvention& engine, const Eigen::Vector3d& p_map);

/// Column by column.
[[nodiscard]] std::array<double, 16> elements(const Eigen::Matrix4d& matrix);

/// The pixel that a point of the engine's world is drawn at on an image of this size (pixel centres at integers, y down), and its depth
/// after the division; nothing behind the eye. The way back, for tests and for picking.
struct DrawnPoint {
  Eigen::Vector2d pixel;
  double depth = 0;
};
[[nodiscard]] std::optional<DrawnPoint> draw_point(const EngineConvention& engine, const VirtualCamera& camera,
                                                   const Eigen::Vector3d& p_world, int width, int height);

/// Where an image of one shape goes in a window of another: pixels of the window, as large as fits, in the middle.
struct Viewport {
  int x = 0, y = 0, width = 0, height = 0;
};
/// All sides positive.
[[nodiscard]] Viewport letterbox(int image_width, int image_height, int window_width, int window_height);

/// A grid over the image that straightens a lens: drawn with the image as its texture it shows what a pinhole with the same focal lengths
/// and principal point would have seen.
struct UndistortionMesh {
  int columns = 0, rows = 0;               ///< of vertices, row by row
  std::vector<Eigen::Vector2d> texture;    ///< where in the recorded image, 0 to 1, y down
  std::vector<Eigen::Vector2d> positions;  ///< where it is drawn, 0 to 1, y down; beyond for what the pinhole sees outside of its image
};
/// At least 2 columns and rows.
[[nodiscard]] UndistortionMesh undistortion_mesh(const Intrinsics& intrinsics, int columns, int rows);

}  // namespace camloc
