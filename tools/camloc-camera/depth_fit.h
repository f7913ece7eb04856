// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The depth camera against the board: what distance it measures where the board is, how much that scatters, and, where depth is
// not registered, how the depth camera stands to the colour camera. The board's plane is known to both: to the colour camera by
// the corners, to the depth camera as a plane of inverse depths, which is linear in normalized image coordinates.
// The extrinsic by planes follows Zhang and Zhang, "Calibration between depth and color sensors for commodity depth cameras"
// (2011), solved in closed form and repeated with the better guess.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/base/result.h"
#include "core/geometry/camera.h"
#include "tools/camloc-camera/lens_fit.h"

namespace camloc::camera_tool {

/// The board in one depth image.
struct DepthPlane {
  Eigen::Vector3d inverse = Eigen::Vector3d::Zero();  ///< 1/z = inverse . (x/z, y/z, 1); normal over distance of the plane
  double z_m = 0;                                     ///< measured, at the middle of the pixels used
  double true_z_m = 0;                                ///< of the board by its corners, at the same place
  double noise_m = 0;                                 ///< standard deviation of single pixels about the plane
  std::size_t num_pixels = 0;
  std::size_t view = 0;  ///< index of the view that shows it
};

struct DepthFit {
  std::vector<DepthPlane> planes;
  double scale = 1, scale_sigma = 0;        ///< measured z = scale * true z + offset
  double offset_m = 0, offset_sigma_m = 0;  ///< 0 where the range of distances is too short to tell it from the scale
  bool has_offset = false;
  DepthNoise noise;              ///< of single pixels
  double near_m = 0, far_m = 0;  ///< distances of the board
};

struct ExtrinsicFit {
  Rigid3 T_color_depth;
  double translation_sigma_m = 0, rotation_sigma_rad = 0;  ///< largest over all directions
  double normal_rms_rad = 0, distance_rms_m = 0;           ///< how well the planes agree
  double depth_scale = 1;  ///< measured over true distance; found together with the translation, which would take it up otherwise
};

/// `T_color_board` belongs to `views` one by one; views without depth are left out. kInvalid: fewer than five show the board's
/// depth.
[[nodiscard]] Result<DepthFit> fit_depth(const Board& board, std::span<const BoardView> views, std::span<const Rigid3> T_color_board,
                                         const RgbdCamera& camera);

/// Starts from camera.T_color_depth, which may be off by some centimetres and degrees. kInvalid: too few planes, or all of them
/// nearly parallel.
[[nodiscard]] Result<ExtrinsicFit> fit_extrinsic(const Board& board, std::span<const BoardView> views,
                                                 std::span<const Rigid3> T_color_board, const RgbdCamera& camera);

}  // namespace camloc::camera_tool
