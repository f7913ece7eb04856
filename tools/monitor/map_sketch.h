// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A map from above in characters, with the camera in it, for a terminal.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/rigid3.h"
#include "core/map/map_view.h"

namespace camloc::tools {

/// x to the right, y up, both to the same scale; a character is taken as twice as high as wide.
class MapSketch {
 public:
  /// `landmarks` and `keyframes` are horizontal positions in the map, metres. Empty where there are no keyframes.
  MapSketch(const std::vector<Eigen::Vector2d>& landmarks, const std::vector<Eigen::Vector2d>& keyframes, int max_columns = 72,
            int max_rows = 18);
  [[nodiscard]] static MapSketch of(const MapView& map, int max_columns = 72, int max_rows = 18);

  /// Lines, each ended by "\n": '.' landmarks, 'o' keyframes, '^' '>' 'v' '<' the camera and where it looks; below them the
  /// scale. A camera outside is shown at the edge.
  [[nodiscard]] std::string draw(const std::optional<Rigid3>& T_map_camera) const;

 private:
  struct Cell {
    int column, row;
  };
  [[nodiscard]] Cell cell_of(const Eigen::Vector2d& p) const;

  std::vector<std::string> rows_;
  Eigen::Vector2d low_ = Eigen::Vector2d::Zero();
  double column_m_ = 1;
};

}  // namespace camloc::tools
