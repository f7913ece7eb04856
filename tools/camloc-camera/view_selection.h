// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Which of the images of a board are worth calibrating with: a hundred alike weigh no more than one, and the lens is known only
// where corners were.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "tools/camloc-camera/lens_fit.h"

namespace camloc::camera_tool {

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

}  // namespace camloc::camera_tool
