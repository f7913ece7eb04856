// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// From images of a board to a camera file: the whole job, without files and printing.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/io/image_file.h"
#include "drivers/frame_source.h"
#include "tools/camloc-camera/depth_fit.h"
#include "tools/camloc-camera/lens_fit.h"

namespace camloc::camera_tool {

/// Corners per cell of a grid over the image, row by row.
struct CoverageGrid {
  static constexpr int kColumns = 10, kRows = 8;
  int width = 0, height = 0;  ///< of the image
  std::vector<int> counts = std::vector<int>(static_cast<std::size_t>(kColumns * kRows));

  void add(const BoardCorners& corners);
  [[nodiscard]] std::size_t cell_of(const Eigen::Vector2d& pixel) const;
  /// Share of the cells with a corner.
  [[nodiscard]] double covered() const;
  /// "the left, the bottom": sides of the image with less than half of their cells covered; "" for none.
  [[nodiscard]] std::string bare_sides() const;
};

struct CalibrationOptions {
  Board board;
  LensModel lens = LensModel::kBrownConrady;
  std::size_t max_views = 40;
  std::optional<RgbdCamera> known;  ///< name, depth intrinsics, unit: what is not measured here
  bool wants_depth = true;
  bool corrects_depth_unit = false;  ///< divide the depth unit by the measured scale
};

struct CalibrationViews {
  std::vector<BoardView> views;
  int width = 0, height = 0;
  std::uint64_t num_frames = 0, num_with_board = 0;
  std::optional<RgbdCamera> source_camera;
};

struct Calibration {
  RgbdCamera camera;
  LensFit lens;  ///< indices into CalibrationViews::views
  std::vector<std::size_t> held_out;
  double held_out_rms_px = 0;
  std::size_t num_held_out_corners = 0;
  CoverageGrid grid;  ///< of the views used
  std::optional<DepthFit> depth;
  std::optional<ExtrinsicFit> extrinsic;
  std::vector<std::string> warnings;
};

/// Called after every frame; false ends the collection.
using CollectProgress = std::function<bool(const CalibrationViews&)>;

/// Reads frames until the source ends, `progress` says so, or there are enough views. A frame that cannot be read is passed over.
/// Errors: those of the source before its first frame.
[[nodiscard]] Result<CalibrationViews> collect_views(FrameSource* source, const CalibrationOptions& options,
                                                     const CollectProgress& progress);

/// Errors: kInvalid with what to show the camera.
[[nodiscard]] Result<Calibration> calibrate(const CalibrationViews& views, const CalibrationOptions& options);

/// Tables of numbers for people.
[[nodiscard]] std::string format_report(const Calibration& calibration, const CalibrationViews& views);
/// The camera file, with how it came about in comments.
[[nodiscard]] std::string format_camera_file(const Calibration& calibration, const std::string& board_text);
/// Cells of the grid, the darker the fewer corners; every corner, with its error 100 times too long; below it what the colours mean.
[[nodiscard]] ColorImage draw_coverage(const Board& board, const Calibration& calibration, const CalibrationViews& views);

// Which of the images are worth calibrating with: a hundred alike weigh no more than one, and the lens is known only where corners
// were (view_selection.cc).

/// Whether the corners lie elsewhere than in each of the views, by `min_shift_px` in the mean.
[[nodiscard]] bool is_new_view(const BoardCorners& corners, std::span<const BoardView> views, double min_shift_px);

struct ViewChoice {
  std::vector<std::size_t> fit;       ///< to calibrate with, best first
  std::vector<std::size_t> held_out;  ///< to test the result on; none of `fit`
};

/// Holds every fourth view out where there are sixteen or more, at most `max_held_out`; of the others takes the one that adds most
/// to coverage and variety of angles, again and again, at most `max_fit`.
[[nodiscard]] ViewChoice choose_views(const Board& board, std::span<const BoardView> views, int width, int height, std::size_t max_fit,
                                      std::size_t max_held_out);

}  // namespace camloc::camera_tool
