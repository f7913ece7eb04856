// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The picture that belongs to a calibration: where in the image corners were, and by how much they miss.
#pragma once

#include <span>

#include "core/io/image_file.h"
#include "tools/camloc-camera/view_selection.h"

namespace camloc::camera_tool {

struct CoveragePicture {
  const Board* board;
  std::span<const BoardView> views;
  const LensFit* fit;
  std::span<const std::size_t> held_out;  ///< indices of views
};

/// Cells of the grid, the darker the fewer corners; every corner, with its error 100 times too long; below it what the colours mean.
[[nodiscard]] ColorImage draw_coverage(const CoveragePicture& picture);

}  // namespace camloc::camera_tool
