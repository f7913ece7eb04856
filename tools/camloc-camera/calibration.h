// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// From images of a board to a camera file: the whole job, without files and printing.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "drivers/frame_source.h"
#include "tools/camloc-camera/depth_fit.h"
#include "tools/camloc-camera/lens_fit.h"
#include "tools/camloc-camera/view_selection.h"

namespace camloc::camera_tool {

struct CalibrationOptions {
  Board board;
  LensFitOptions lens;
  std::size_t max_views = 40, max_held_out = 15;
  std::size_t max_candidates = 150;  ///< different views that are collected
  double min_shift = 0.03;           ///< of the image's width, by which a view must differ from the others
  std::optional<RgbdCamera> known;   ///< name, depth intrinsics, unit: what is not measured here
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

}  // namespace camloc::camera_tool
