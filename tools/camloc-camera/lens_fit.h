// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Intrinsics and distortion from views of a flat board: Zhang, "A flexible new technique for camera calibration" (2000), by
// OpenCV's least squares; the equidistant lens after Kannala and Brandt (2006). What is ours is the choice of views, the removal
// of bad ones, and saying when the views do not determine the answer.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "core/base/frame.h"
#include "core/base/result.h"
#include "core/geometry/camera.h"
#include "tools/camloc-camera/board.h"

namespace camloc::camera_tool {

/// One image of the board, and the depth image of the same time where there is one.
struct BoardView {
  std::uint64_t sequence = 0;
  BoardCorners corners;
  Image<std::uint16_t> depth;
};

struct LensFit {
  Intrinsics intrinsics;
  std::array<double, 4> sigma{};             ///< of fx fy cx cy, pixels
  std::array<double, 5> distortion_sigma{};  ///< 0 where a coefficient was held at 0
  double rms_px = 0;                         ///< of the distances, over the corners of the views used
  double max_tilt_rad = 0;                   ///< of the board out of the image plane, over the views used
  std::vector<std::size_t> used, dropped;    ///< indices of the views
  std::vector<double> view_rms_px;           ///< as `used`
  std::vector<Rigid3> T_camera_board;        ///< as `used`
};

/// `lens`: kPinhole is without distortion. Errors: kInvalid with what to do: too few views, all of them from the front, focal length not
/// determined.
[[nodiscard]] Result<LensFit> fit_lens(const Board& board, std::span<const BoardView> views, int width, int height,
                                       LensModel lens = LensModel::kBrownConrady);

/// The board's pose by its corners; kInvalid where they do not give one.
[[nodiscard]] Result<Rigid3> find_board(const Board& board, const BoardCorners& corners, const Intrinsics& intrinsics);

/// Distances of the corners from where the pose puts them, pixels: measured minus predicted.
[[nodiscard]] std::vector<Eigen::Vector2d> reprojection_errors(const Board& board, const BoardCorners& corners,
                                                               const Intrinsics& intrinsics, const Rigid3& T_camera_board);

}  // namespace camloc::camera_tool
