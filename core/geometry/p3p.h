// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Perspective-three-point: the camera poses that see three known points along three known directions.
#pragma once

#include <Eigen/Core>
#include <array>

#include "core/geometry/rigid3.h"

namespace camloc {

/// Up to four poses; only the first `count` are set.
struct P3pSolutions {
  std::array<Eigen::Matrix3d, 4> R_camera_map;
  std::array<Eigen::Vector3d, 4> t_camera_map;
  int count = 0;
};

/// Solves depth_i * bearing_camera_i = R * p_map_i + t, i = 0..2, depth_i > 0. Bearings are unit vectors. Collinear or
/// coincident points give no solution. The two quadratic equations between the depths are intersected through a degenerate
/// member of their pencil (Persson and Nordberg, "Lambda Twist: an accurate fast robust perspective three point solver",
/// 2018; Ding, Yang, Larsson, Olsson, Astrom, "Revisiting the P3P problem", 2023), and each root is polished by Newton.
[[nodiscard]] P3pSolutions solve_p3p(const std::array<Eigen::Vector3d, 3>& bearings_camera,
                                     const std::array<Eigen::Vector3d, 3>& points_map);

}  // namespace camloc
