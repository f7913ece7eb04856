// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <string>

#include "tools/mapping/site/control_points.h"

namespace camloc::mapping {
namespace {

TEST(PointPairs, HaveBothPlacesAndASigma) {
  const auto pairs = parse_point_pairs("# map, cloud\nA 1 2 3 4 5 6\nB 1 2 4 4 5 7 0.5\n\nC 0 0 0 1 1 1\n", "p.txt");
  ASSERT_TRUE(pairs.is_ok()) << pairs.status().message();
  ASSERT_EQ(pairs->size(), 3U);
  EXPECT_EQ((*pairs)[0].p_map, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ((*pairs)[0].p_cloud, Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ((*pairs)[1].sigma_m, 0.5);
  EXPECT_EQ((*pairs)[2].name, "C");
}

TEST(PointPairs, NamesMayHoldBlanks) {
  for (const char* text : {"Door 3\t0.5\t0.4\t0.6\t0.7\t0.8\t0.9\nB 1\t1\t2\t3\t4\t5\t6\nC\t1\t2\t3\t4\t5\t7\n",
                           "name;x;y;z;u;v;w;\nDoor 3;0,5;0,4;0,6;0,7;0,8;0,9;\nB 1;1;2;3;4;5;6;\nC;1;2;3;4;5;7;;\n",
                           "'Door 3' 0.5 0.4 0.6 0.7 0.8 0.9\n\"B 1\" 1 2 3 4 5 6\nC 1 2 3 4 5 7\n",
                           "Door 3,0.5,0.4,0.6,0.7,0.8,0.9\nB 1,1,2,3,4,5,6\nC,1,2,3,4,5,7\n"}) {
    SCOPED_TRACE(text);
    const auto pairs = parse_point_pairs(text, "p.txt");
    ASSERT_TRUE(pairs.is_ok()) << pairs.status().message();
    ASSERT_EQ(pairs->size(), 3U);
    EXPECT_EQ((*pairs)[0].name, "Door 3");
    EXPECT_EQ((*pairs)[0].p_map, Eigen::Vector3d(0.5, 0.4, 0.6));
    EXPECT_EQ((*pairs)[0].p_cloud, Eigen::Vector3d(0.7, 0.8, 0.9));
    EXPECT_EQ((*pairs)[0].sigma_m, 0.01);
    EXPECT_EQ((*pairs)[1].name, "B 1");
  }
}

TEST(PointPairs, ANumberOfANameIsNotTakenForACoordinate) {
  const auto pairs = parse_point_pairs("Door 3 0.5 0.4 0.6 0.7 0.8 0.9\nB 1 2 3 4 5 6\nC 1 2 3 4 5 7\n", "p.txt");
  ASSERT_FALSE(pairs.is_ok());
  EXPECT_NE(pairs.status().message().find("p.txt:1: does the name hold a blank?"), std::string::npos) << pairs.status().message();
}

TEST(PointPairs, ErrorsNameFileAndLine) {
  const std::string good = "A 1 2 3 4 5 6\nB 1 2 4 4 5 7\nC 0 0 0 1 1 1\n";
  for (const auto& [line, part] : {std::pair{"D 1 2 3 4 5\n", "p.txt:4: has 6 fields"},
                                   {"D 1 2 3 4 5 six\n", "p.txt:4: 'six' is no number"},
                                   {"D 1 2 3 4 5 nan\n", "p.txt:4: 'nan'"},
                                   {"D 1 2 3 4 5 6 0\n", "sigma must be positive"},
                                   {"A 1 2 3 4 5 6\n", "point 'A' was given before"}}) {
    const auto pairs = parse_point_pairs(good + line, "p.txt");
    ASSERT_FALSE(pairs.is_ok()) << line;
    EXPECT_NE(pairs.status().message().find(part), std::string::npos) << pairs.status().message();
  }
  EXPECT_NE(parse_point_pairs("A 1 2 3 4 5 6\n", "p.txt").status().message().find("at least 3"), std::string::npos);
  EXPECT_EQ(read_point_pairs("/nowhere/p.txt").status().code(), ErrorCode::kNotFound);
}

}  // namespace
}  // namespace camloc::mapping
