// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Tables that people and programs write.
#include <gtest/gtest.h>

#include <string>

#include "tests/mapping/cloud_bytes.h"

namespace camloc::mapping {
namespace {

TEST(CloudText, ReadsTextTables) {
  const char* const tables[] = {
      "1.5 -2.25 0.5\n2 4 8\n-3.125 0 1\n",
      "# exported\n// by hand\n% twice\n\n1.5\t-2.25\t0.5\t255\t0\t0\r\n2 4 8 1 2 3\r\n# between\r\n-3.125 0 1 0 0 0\r\n",
      "X,Y,Z,Red\n1.5,-2.25,0.5,9\n2,4,8,9\n-3.125,0,1,9",
      "//X,Y,Z\n1.5,-2.25,0.5\n2,4,8\n-3.125,0,1\n",
      "\"intensity\";\"Z\";\"X\";\"Y\"\n7;0,5;1,5;-2,25\n7;8;2;4\n7;1;-3,125;0\n",
      "3\n1.5 -2.25 0.5 -1200 10 20 30\n2 4 8 0 0 0 0\n-3.125 0 1 0 0 0 0\n",
  };
  for (const char* table : tables) {
    SCOPED_TRACE(table);
    expect_points(read(table, "a.txt"), kPoints);
  }
}

TEST(CloudText, ReadsDecimalCommasWhereBlanksSeparate) {
  for (const char* table : {"1,5\t-2,25\t0,5\n2,0\t4,0\t8,0\n-3,125\t0,0\t1,0\n", "x y z\n1,5 -2,25 0,5 17\n2 4 8 17\n-3,125 0 1,0 17",
                            "3\n1,5 -2,25 0,5 -12 1 2 3\n2 4 8 -9 1 2 3\n-3,125 0 1 0 0 0 0\n"}) {
    SCOPED_TRACE(table);
    const auto cloud = read(table, "a.txt");
    expect_points(cloud, kPoints);
    ASSERT_EQ(cloud->notes.size(), 1U);
    EXPECT_NE(cloud->notes[0].find("decimal"), std::string::npos);
  }
}

TEST(CloudText, TakesACommaForASeparatorAsSoonAsOneLineHasItSo) {
  expect_points(read("1.5, -2.25, 0.5\n2, 4, 8\n-3.125, 0, 1\n", "a.txt"), kPoints);
  expect_points(read("1.5,-2.25,0.5 255 0 0\n2,4,8 255 0 0\n-3.125,0,1 255 0 0\n", "a.txt"), kPoints);
  expect_error(read("5,334,567.12 1,250.00 3.00\n5,334,568.12 1,250.00 3.00\n", "a.txt"), ErrorCode::kInvalid, "thousands");
}

TEST(CloudText, ReadsPtsOfSeveralScans) {
  expect_points(read("2\n1.5 -2.25 0.5 1 0 0 0\n2 4 8 1 0 0 0\n1\n-3.125 0 1 1 0 0 0\n", "a.pts"), kPoints);
  expect_error(read("2\n1.5 -2.25 0.5 1 0 0 0\n2 4 8 1 0 0 0\n2\n-3.125 0 1 1 0 0 0\n", "a.pts"), ErrorCode::kCorrupt, "promises 4");
  expect_error(read("2\n1.5 -2.25 0.5\n1\n2 4 8\n", "a.pts"), ErrorCode::kInvalid, "a.pts:3");
}

TEST(CloudText, RefusesBadText) {
  expect_error(read("1 2 3\n4 5\n", "a.xyz"), ErrorCode::kInvalid, "a.xyz:2");
  expect_error(read("1 2 3\nhello you there\n", "a.xyz"), ErrorCode::kInvalid, "a.xyz:2");
  expect_error(read("5\n1 2 3\n4 5 6\n", "a.pts"), ErrorCode::kCorrupt, "promises 5");
  expect_error(read("99999999999\n1 2 3\n", "a.pts"), ErrorCode::kCorrupt, "promises 99999999999");
  expect_error(read("x,y,z\n", "a.csv"), ErrorCode::kInvalid, "no points");
  expect_error(read("Dear reader, this is a letter.\nYours", "a.txt"), ErrorCode::kInvalid, "a.txt:2");
}

}  // namespace
}  // namespace camloc::mapping
