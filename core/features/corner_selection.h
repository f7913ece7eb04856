// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Corners of one pyramid level, spread evenly: every grid cell gives its strongest first, then its second strongest, until
// the level's share of features is used up.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/features/fast_corners.h"
#include "core/features/image_pyramid.h"

namespace camloc {

struct Corner {
  std::int16_t x = 0, y = 0;  ///< pixels of the level
  std::uint8_t score = 0;     ///< FAST score
};

/// Allocates at construction only. Not thread-safe.
class CornerSelector {
 public:
  /// Levels given to select() are at most this large, and at most `max_corners` are asked for.
  CornerSelector(int max_width, int max_height, int max_corners);
  /// At most `count` corners, ordered by row, then column; valid until the next call.
  std::span<const Corner> select(const PaddedImage& level, int count);

 private:
  struct Cell {
    int x0, y0, x1, y1;  ///< pixels [x0, x1) x [y0, y1)
    Corner* corners;
    int count;
    bool is_weak;  ///< had no corner at the first threshold
  };
  void lay_out_cells(const PaddedImage& level);
  void score(const PaddedImage& level, int x0, int y0, int x1, int y1, int threshold);
  void collect(int x0, int y0, int x1, int y1);
  void add(Cell* cell, Corner corner);
  void take_evenly(int count);

  FastScoresFunction fast_scores_;
  PaddedImage scores_;
  std::vector<Cell> cells_;  ///< row by row
  int columns_ = 0;          ///< of cells
  std::vector<Corner> corner_of_cell_;
  std::vector<Corner> selected_;
};

}  // namespace camloc
