// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/monitor/map_sketch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

namespace camloc::tools {
namespace {

std::vector<std::string> rows_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// Walls of a room of 8 x 4 m, keyframes along its middle.
MapSketch room(int columns, int rows) {
  std::vector<Eigen::Vector2d> landmarks, keyframes;
  for (int i = 0; i <= 500; ++i) {
    const double t = 0.002 * i;
    for (const double side : {0.0, 1.0}) {
      landmarks.emplace_back(8 * t, 4 * side);
      landmarks.emplace_back(8 * side, 4 * t);
    }
  }
  for (int i = 0; i <= 8; ++i) keyframes.emplace_back(2 + 0.5 * i, 2);
  return MapSketch(landmarks, keyframes, columns, rows);
}

/// A camera at (x, y) that looks along `forward`.
Rigid3 camera_at(double x, double y, const Eigen::Vector3d& forward) {
  return {shortest_turn(Eigen::Vector3d::UnitZ(), forward.normalized()), {x, y, 1.5}};
}

TEST(MapSketchTest, KeepsItsSizeAndShowsTheCamera) {
  const auto lines = rows_of(room(72, 18).draw(camera_at(6, 3.5, {0, 1, 0})));
  ASSERT_EQ(lines.size(), 19U);  // 4 m in rows of 2 x 4/34 m, and the scale
  for (std::size_t i = 0; i + 1 < lines.size(); ++i) EXPECT_LE(lines[i].size(), 74U);
  EXPECT_EQ(lines[0].find("  ...."), 0U) << lines[0];
  std::size_t row = 0;
  while (row < lines.size() && lines[row].find('^') == std::string::npos) ++row;
  EXPECT_EQ(row, 3U) << "half a metre, a bit more than two rows, from the upper wall";
  EXPECT_NEAR(static_cast<double>(lines[row].find('^')), 2 + 6 * 34 / 4.0, 1.0);
  EXPECT_NE(lines[9].find("o   o"), std::string::npos) << lines[9];
}

TEST(MapSketchTest, ArrowsPointWhereTheCameraLooks) {
  const MapSketch sketch = room(40, 10);
  for (const auto& [forward, arrow] :
       {std::pair<Eigen::Vector3d, char>{{1, 0, 0}, '>'}, {{-1, 0, 0}, '<'}, {{0, -1, 0}, 'v'}, {{0, 0, -1}, '+'}}) {
    const auto lines = rows_of(sketch.draw(camera_at(4, 1, forward)));
    bool is_there = false;
    for (std::size_t i = 0; i + 1 < lines.size(); ++i) is_there = is_there || lines[i].find(arrow) != std::string::npos;
    EXPECT_TRUE(is_there) << arrow;
  }
}

TEST(MapSketchTest, OutsideAndNothing) {
  const MapSketch sketch = room(40, 10);
  EXPECT_NE(sketch.draw(camera_at(1000, -1000, {1, 0, 0})).find('>'), std::string::npos);
  EXPECT_EQ(sketch.draw(camera_at(std::nan(""), 0, {1, 0, 0})), sketch.draw(std::nullopt));
  EXPECT_EQ(MapSketch({}, {}).draw(std::nullopt), "");
  EXPECT_NE(MapSketch({}, {{5, 5}}).draw(std::nullopt).find('o'), std::string::npos) << "one keyframe is a map";
}

}  // namespace
}  // namespace camloc::tools
