// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Control point files as people and survey programs write them.
#include "tools/mapping/site/control_points.h"

#include <gtest/gtest.h>

namespace camloc::mapping {
namespace {

std::vector<ControlPoint> points_of(const std::string& text) {
  const auto points = parse_control_points(text, "site.csv");
  EXPECT_TRUE(points.is_ok()) << points.status().message();
  return points.is_ok() ? *points : std::vector<ControlPoint>{};
}

TEST(ControlPoints, BlanksCommasSemicolonsAndTabs) {
  for (const char* text : {"A1 1.5 -2 3e0 0.005\nB 4 5 6\n", "A1,1.5,-2,3,0.005\nB,4,5,6\n", "\"A1\"; 1.5; -2; +3; 0.005\r\nB;4;5;6;\r\n",
                           "A1\t1.5\t-2\t3\t0.005\nB\t4\t5\t6", "# site\n\nA1, 1.5 -2 3 0.005  # corner\n  B 4 5 6\n"}) {
    const std::vector<ControlPoint> points = points_of(text);
    ASSERT_EQ(points.size(), 2U) << text;
    EXPECT_EQ(points[0].name, "A1");
    EXPECT_EQ(points[0].p_wcs, Eigen::Vector3d(1.5, -2, 3));
    EXPECT_EQ(points[0].sigma_m, 0.005);
    EXPECT_EQ(points[1].name, "B");
    EXPECT_EQ(points[1].sigma_m, kDefaultPointSigmaM);
  }
}

TEST(ControlPoints, NamesMayHoldBlanksAndHashes) {
  const std::vector<ControlPoint> points = points_of("Door left,1,2,3\nPt#2 4 5 6\n");
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points[0].name, "Door left");
  EXPECT_EQ(points[1].name, "Pt#2");
}

TEST(ControlPoints, TitlesGiveTheOrderOfColumns) {
  const std::vector<ControlPoint> points =
      points_of("Point,Northing,Easting,Code,Elevation,Sigma_m\nA,5432109.876,456789.123,WALL,12.5,0.004\n");
  ASSERT_EQ(points.size(), 1U);
  EXPECT_EQ(points[0].p_wcs, Eigen::Vector3d(456789.123, 5432109.876, 12.5));  // to the last bit
  EXPECT_EQ(points[0].sigma_m, 0.004);
}

TEST(ControlPoints, ErrorsNameFileLineAndField) {
  const struct {
    const char* text;
    const char* part;
  } cases[] = {
      {"", "site.csv: no control point"},
      {"# nothing\n", "site.csv: no control point"},
      {"name,x,y,z\n", "site.csv: no control point"},
      {"A 1 2 3\nB 1 2\n", "site.csv:2: 3 fields"},
      {"A 1 2 x\n", "site.csv:1: z 'x' is not a number"},
      {"A 1 nan 3\n", "y 'nan' is not a number"},
      {"A 1 2 1e12\n", "z '1e12' is out of range"},
      {"A;1,5;2.5;3\n", "x '1,5' is not a number (decimal point"},
      {"Door 3 0.5 0.4 0.6\n", "site.csv:1: does the name hold a blank?"},
      {"A 1 2 3 0\n", "sigma must be positive"},
      {"A 1 2 3 -1\n", "sigma '-1' is out of range"},
      {"A 1 2 3 WALL\n", "sigma 'WALL'"},
      {"A\x1b[2J 1 2 3\n", "control characters"},
      {"A 1 2 3\nB 1 2 3\nA 4 5 6\n", "site.csv:3: point 'A' is already in line 1"},
  };
  for (const auto& one : cases) {
    const auto points = parse_control_points(one.text, "site.csv");
    ASSERT_FALSE(points.is_ok()) << one.text;
    EXPECT_NE(points.status().message().find(one.part), std::string::npos) << points.status().message();
  }
  EXPECT_EQ(read_control_points("/nowhere/site.csv").status().code(), ErrorCode::kNotFound);
}

TEST(ControlObservations, ThreeKinds) {
  const auto observations = parse_control_observations(
      "A map 1 2 3\nA map 1 2 3 0.05\nDoor left, landmark, 17\nB pixel 12 320.5 240 2\nB Pixel 13 0 -0.5\n", "seen.txt");
  ASSERT_TRUE(observations.is_ok()) << observations.status().message();
  ASSERT_EQ(observations->size(), 5U);
  EXPECT_EQ((*observations)[0].sigma, kDefaultPickedSigmaM);
  EXPECT_EQ((*observations)[1].sigma, 0.05);
  EXPECT_EQ((*observations)[2].name, "Door left");
  EXPECT_EQ((*observations)[2].landmark, 17U);
  EXPECT_EQ((*observations)[3].frame, 12U);
  EXPECT_EQ((*observations)[3].u, 320.5);
  EXPECT_EQ((*observations)[3].sigma, 2);
  EXPECT_EQ((*observations)[4].sigma, kDefaultPixelSigmaPx);
  EXPECT_EQ(describe((*observations)[3]), "pixel (320.5, 240.0) of frame 12");
}

TEST(ControlObservations, ErrorsNameFileLineAndField) {
  const struct {
    const char* text;
    const char* part;
  } cases[] = {
      {"", "seen.txt: no observation"},
      {"A 1 2 3\n", "seen.txt:1: '1' is not 'map', 'landmark' or 'pixel'"},
      {"A\n", "'' is not 'map'"},
      {"A map 1 2\n", "4 fields, expected 'name map x y z"},
      {"A map 1 2 3 4 5\n", "7 fields"},
      {"A pixel 1 2\n", "expected 'name pixel FRAME u v"},
      {"A pixel -1 2 3\n", "frame '-1'"},
      {"A pixel 1 2 99999\n", "v '99999' is out of range"},
      {"A landmark 1.5\n", "landmark '1.5'"},
      {"A map 1 2 3\nA landmark\n", "seen.txt:2: 2 fields"},
  };
  for (const auto& one : cases) {
    const auto observations = parse_control_observations(one.text, "seen.txt");
    ASSERT_FALSE(observations.is_ok()) << one.text;
    EXPECT_NE(observations.status().message().find(one.part), std::string::npos) << observations.status().message();
  }
}

}  // namespace
}  // namespace camloc::mapping
