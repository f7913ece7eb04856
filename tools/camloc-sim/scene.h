// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A building as a list of flat rectangles lit by lamps. World frame: metres, z up, floor at z = 0.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "tools/camloc-sim/texture.h"

namespace camloc::sim {

/// Point (u, v) of a surface is origin + u * u_axis + v * v_axis, 0 <= u <= width, 0 <= v <= height. It is seen only from
/// the side its normal u_axis x v_axis points to.
struct Surface {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  Eigen::Vector3d u_axis = Eigen::Vector3d::UnitX();
  Eigen::Vector3d v_axis = Eigen::Vector3d::UnitY();
  double width = 1, height = 1;  ///< metres
  Skin skin;
  float texture_u = 0, texture_v = 0;           ///< texture coordinates of `origin`, metres: pieces of one wall line up
  float texture_width = 1, texture_height = 1;  ///< size of the whole thing the texture belongs to, metres
  int room = 0;                                 ///< lamps of other rooms do not reach it
  bool is_static = true;                        ///< clutter and people are not in the LiDAR cloud

  // Light on the surface, filled by Scene::bake_light: nodes light_columns x light_rows, evenly spaced, borders included.
  int light_columns = 0, light_rows = 0;
  std::vector<float> light = {};

  [[nodiscard]] Eigen::Vector3d normal() const { return u_axis.cross(v_axis); }
  [[nodiscard]] Eigen::Vector3d at(double u, double v) const { return origin + u * u_axis + v * v_axis; }
};

struct Lamp {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  double power = 1;
  int room = 0;
  bool is_window = false;  ///< daylight: shines into the room from the side, also upwards
};

/// A local frame on the floor plan: x and y of the plan turned by `angle_rad` and moved to `origin`.
struct Placement {
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();
  double angle_rad = 0;

  [[nodiscard]] Eigen::Vector3d point(double x, double y, double z) const;
  [[nodiscard]] Eigen::Vector3d direction(double x, double y) const;
  [[nodiscard]] Placement child(double x, double y, double child_angle_rad) const;
};

/// Overall light of a day.
struct DayLight {
  double ambient = 0.22;                           ///< light that comes from everywhere
  Eigen::Vector3d tilt = Eigen::Vector3d::Zero();  ///< surfaces facing this way are brighter: colour and side of the light
};

struct Box {
  double x0, y0, z0, x1, y1, z1;  ///< metres, in a Placement
};

class Scene {
 public:
  std::vector<Surface> surfaces;
  std::vector<Lamp> lamps;
  DayLight day_light;

  /// A rectangle; returns it for further settings. Texture coordinates start at its origin.
  Surface& add(const Eigen::Vector3d& origin, const Eigen::Vector3d& u_axis, const Eigen::Vector3d& v_axis, double width, double height,
               const Skin& skin, int room);
  /// Upright rectangle from (x0, y0) to (x1, y1) in the placement, left to right as its viewer sees it, between two heights.
  Surface& add_upright(const Placement& place, double x0, double y0, double x1, double y1, double z0, double z1, const Skin& skin,
                       int room);
  /// Horizontal rectangle facing up.
  Surface& add_floor(const Placement& place, double x0, double y0, double x1, double y1, double z, const Skin& skin, int room);
  /// Horizontal rectangle facing down.
  Surface& add_ceiling(const Placement& place, double x0, double y0, double x1, double y1, double z, const Skin& skin, int room);
  /// Outer faces of a box; `front` is the face at y0. No bottom where nobody can look under it.
  void add_box(const Placement& place, const Box& box, const Skin& sides, const Skin& front, int room, bool is_static);

  /// Light arriving at a point with the given normal.
  [[nodiscard]] float light_at(const Eigen::Vector3d& point, const Eigen::Vector3d& normal, int room) const;
  /// Fills the light nodes of one surface, or of all.
  void bake_light(Surface* surface) const;
  void bake_light();
};

}  // namespace camloc::sim
