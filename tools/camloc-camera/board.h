// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A flat calibration board: what it looks like, and where its corners are in an image. The corners lie in the plane z = 0 of the
// frame `board`, x along a row, y down the columns.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/base/frame.h"
#include "core/base/result.h"

namespace camloc::camera_tool {

struct Board {
  enum class Kind { kChessboard, kCharuco };
  Kind kind = Kind::kChessboard;
  int columns = 0, rows = 0;  ///< chessboard: inner corners; ChArUco: squares
  double square_m = 0;
  double marker_m = 0;  ///< ChArUco only
  int dictionary = 0;   ///< ChArUco only: cv::aruco::PREDEFINED_DICTIONARY_NAME

  [[nodiscard]] int num_corners() const;
  /// Row by row; the index is the corner's id.
  [[nodiscard]] Eigen::Vector2d corner_m(int id) const;
};

/// "chessboard:9x6:25mm" (inner corners, side of a square) or "charuco:7x5:40mm:30mm:DICT_5X5_100" (squares, side of a square and
/// of a marker, dictionary of OpenCV, DICT_5X5_100 by default). Lengths in mm, cm or m. kInvalid says what is wrong.
[[nodiscard]] Result<Board> parse_board(const std::string& text);

/// Corners of the board that one image shows.
struct BoardCorners {
  std::vector<int> ids;
  std::vector<Eigen::Vector2d> pixels;  ///< pixel centres at integers
};

/// Empty where the board is not seen. A chessboard is seen whole or not at all; of a ChArUco board at least eight corners that are
/// not all in one row.
[[nodiscard]] BoardCorners detect_board(const Board& board, const Image<std::uint8_t>& gray);

}  // namespace camloc::camera_tool
