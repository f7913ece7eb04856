// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/camloc-camera/board.h"

#include <algorithm>
#include <array>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/calib3d.hpp>
#include <optional>
#include <set>
#include <string_view>

#include "core/io/text.h"

namespace camloc::camera_tool {
namespace {

constexpr std::size_t kMinCharucoCorners = 8;
constexpr int kMaxSide = 60;

/// In the order of cv::aruco::PREDEFINED_DICTIONARY_NAME.
constexpr std::array<std::string_view, 17> kDictionaries{
    "DICT_4X4_50",  "DICT_4X4_100",  "DICT_4X4_250", "DICT_4X4_1000", "DICT_5X5_50",        "DICT_5X5_100",
    "DICT_5X5_250", "DICT_5X5_1000", "DICT_6X6_50",  "DICT_6X6_100",  "DICT_6X6_250",       "DICT_6X6_1000",
    "DICT_7X7_50",  "DICT_7X7_100",  "DICT_7X7_250", "DICT_7X7_1000", "DICT_ARUCO_ORIGINAL"};
static_assert(cv::aruco::DICT_4X4_50 == 0 && cv::aruco::DICT_ARUCO_ORIGINAL + 1 == kDictionaries.size());

std::optional<double> parse_length_m(std::string_view text) {
  for (const auto& [unit, scale] : {std::pair<std::string_view, double>{"mm", 1e-3}, {"cm", 1e-2}, {"m", 1.0}}) {
    if (!text.ends_with(unit)) continue;
    const std::optional<double> value = parse_double(text.substr(0, text.size() - unit.size()));
    if (value && *value * scale >= 1e-3 && *value * scale <= 1) return *value * scale;
    return std::nullopt;
  }
  return std::nullopt;
}

bool parse_sides(std::string_view text, int least, int* columns, int* rows) {
  const std::size_t cross = text.find('x');
  if (cross == std::string_view::npos) return false;
  const auto first = parse_int(text.substr(0, cross)), second = parse_int(text.substr(cross + 1));
  if (!first || !second || *first < least || *second < least || *first > kMaxSide || *second > kMaxSide) return false;
  *columns = static_cast<int>(*first);
  *rows = static_cast<int>(*second);
  return true;
}

Status parse_charuco(const std::vector<std::string_view>& parts, const std::string& context, Board* board) {
  board->kind = Board::Kind::kCharuco;
  const std::optional<double> marker_m = parts.size() > 3 ? parse_length_m(parts[3]) : std::nullopt;
  if (!marker_m || *marker_m >= board->square_m)
    return {ErrorCode::kInvalid, context + "the side of a marker is missing, or not smaller than that of a square"};
  board->marker_m = *marker_m;
  const std::string_view name = parts.size() > 4 ? parts[4] : "DICT_5X5_100";
  const auto found = std::find(kDictionaries.begin(), kDictionaries.end(), name);
  if (found == kDictionaries.end()) {
    std::string known;
    for (const std::string_view other : kDictionaries) known += (known.empty() ? "" : ", ") + std::string(other);
    return {ErrorCode::kInvalid, context + "no dictionary " + in_quotes(name) + "; known: " + known};
  }
  board->dictionary = static_cast<int>(found - kDictionaries.begin());
  const int num_markers = board->columns * board->rows / 2;
  if (cv::aruco::getPredefinedDictionary(board->dictionary)->bytesList.rows < num_markers) {
    return {ErrorCode::kInvalid, context + std::string(name) + " has too few markers, " + std::to_string(num_markers) + " are needed"};
  }
  return Status::ok();
}

BoardCorners detect_chessboard(const cv::Mat& gray, const Board& board) {
  std::vector<cv::Point2f> found;
  if (!cv::findChessboardCornersSB(gray, {board.columns, board.rows}, found, cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_ACCURACY))
    return {};
  BoardCorners corners;
  for (std::size_t i = 0; i < found.size(); ++i) {
    corners.ids.push_back(static_cast<int>(i));
    corners.pixels.emplace_back(found[i].x, found[i].y);
  }
  return corners;
}

/// A line of corners says nothing about a plane.
bool spans_plane(const Board& board, const std::vector<int>& ids) {
  std::set<int> columns, rows;
  for (const int id : ids) {
    columns.insert(id % (board.columns - 1));
    rows.insert(id / (board.columns - 1));
  }
  return columns.size() >= 2 && rows.size() >= 2;
}

}  // namespace

int Board::num_corners() const { return kind == Kind::kChessboard ? columns * rows : (columns - 1) * (rows - 1); }

Eigen::Vector2d Board::corner_m(int id) const {
  const int per_row = kind == Kind::kChessboard ? columns : columns - 1;
  const double first = kind == Kind::kChessboard ? 0 : 1;  // a ChArUco board's origin is the corner of its first square
  return square_m * Eigen::Vector2d(first + id % per_row, first + id / per_row);
}

Result<Board> parse_board(const std::string& text) {
  const std::string context = "--board " + text + ": ";
  const std::vector<std::string_view> parts = split_fields(text, ":");
  const bool is_charuco = !parts.empty() && parts[0] == "charuco";
  if (parts.empty() || (!is_charuco && parts[0] != "chessboard")) {
    return Status(ErrorCode::kInvalid, context + "expected chessboard:9x6:25mm or charuco:7x5:40mm:30mm:DICT_5X5_100");
  }
  if (parts.size() > (is_charuco ? 5U : 3U)) return Status(ErrorCode::kInvalid, context + "too many parts");
  Board board;
  if (parts.size() < 2 || !parse_sides(parts[1], 3, &board.columns, &board.rows)) {
    return Status(ErrorCode::kInvalid,
                  context + (is_charuco ? "expected the number of squares as 7x5" : "expected the number of inner corners as 9x6") +
                      ", each 3 to 60");
  }
  const std::optional<double> square_m = parts.size() > 2 ? parse_length_m(parts[2]) : std::nullopt;
  if (!square_m) return Status(ErrorCode::kInvalid, context + "expected the side of a square with its unit, as 25mm, 1 mm to 1 m");
  board.square_m = *square_m;
  if (is_charuco) {
    if (Status status = parse_charuco(parts, context, &board); !status) return status;
  }
  return board;
}

BoardCorners detect_board(const Board& board, const Image<std::uint8_t>& gray) {
  // OpenCV takes pixels it does not change through a pointer to non-const.
  const cv::Mat image(gray.height, gray.width, CV_8UC1, const_cast<std::uint8_t*>(gray.pixels.data()));
  try {
    if (board.kind == Board::Kind::kChessboard) return detect_chessboard(image, board);
    const auto charuco =
        cv::aruco::CharucoBoard::create(board.columns, board.rows, static_cast<float>(board.square_m), static_cast<float>(board.marker_m),
                                        cv::aruco::getPredefinedDictionary(board.dictionary));
    std::vector<std::vector<cv::Point2f>> markers, rejected;
    std::vector<int> marker_ids;
    cv::aruco::detectMarkers(image, charuco->dictionary, markers, marker_ids, cv::aruco::DetectorParameters::create(), rejected);
    cv::aruco::refineDetectedMarkers(image, charuco, markers, marker_ids, rejected);
    if (marker_ids.empty()) return {};
    cv::Mat pixels, ids;
    cv::aruco::interpolateCornersCharuco(markers, marker_ids, image, charuco, pixels, ids);
    BoardCorners corners;
    for (int i = 0; i < ids.rows; ++i) {
      corners.ids.push_back(ids.at<int>(i));
      corners.pixels.emplace_back(pixels.at<cv::Point2f>(i).x, pixels.at<cv::Point2f>(i).y);
    }
    return corners.ids.size() >= kMinCharucoCorners && spans_plane(board, corners.ids) ? corners : BoardCorners{};
  } catch (const cv::Exception&) {
    return {};  // what OpenCV cannot make sense of shows no board
  }
}

}  // namespace camloc::camera_tool
