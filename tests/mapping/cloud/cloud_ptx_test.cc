// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Leica's PTX: scans that stand turned and aside.
#include <gtest/gtest.h>

#include <string>

#include "tests/mapping/cloud_bytes.h"

namespace camloc::mapping {
namespace {

/// A quarter turn about z (the scanner's x is the site's y) and a shift of (10, 20, 1).
const std::string kTurned = "10 20 1\n0 1 0\n-1 0 0\n0 0 1\n0 1 0 0\n-1 0 0 0\n0 0 1 0\n10 20 1 1\n";
const std::string kPlain = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";

TEST(CloudPtx, PlacesEachScanByItsMatrix) {
  const auto cloud = read(
      "2\n2\n" + kTurned + "1 2 3 0.5\n0 0 0 0.5\n4 0 0 0.5 1 2 3\n0 0 0 0.5 0 0 0\n" + "1\r\n1\r\n" + kPlain + "7 8 9 0.1\n", "a.ptx");
  expect_points(cloud, {{8, 21, 4}, {10, 24, 1}, {7, 8, 9}});
  EXPECT_EQ(cloud->num_read, 5U);
  EXPECT_EQ(cloud->num_invalid, 2U);
  ASSERT_EQ(cloud->notes.size(), 1U);
  EXPECT_NE(cloud->notes[0].find("2 scans"), std::string::npos) << cloud->notes[0];
  expect_points(read("1\n1\n" + kPlain + "7 8 9 0.1\n", "renamed.txt"), {{7, 8, 9}});
}

TEST(CloudPtx, RefusesWhatIsNone) {
  expect_error(read("2\n2\n" + kTurned + "1 2 3 0.5\n", "a.ptx"), ErrorCode::kCorrupt, "promises 4");
  expect_error(read("900000\n900000\n" + kTurned + "1 2 3 0.5\n", "a.ptx"), ErrorCode::kCorrupt, "promises 810000000000");
  expect_error(read("1\n1\n" + kPlain + "1 2 3 0.5\n4 5 6 0.5\n", "a.ptx"), ErrorCode::kInvalid, "a.ptx:12: no PTX header");
  expect_error(read("1\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n2 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n1 2 3 4\n", "a.ptx"), ErrorCode::kInvalid,
               "no rotation");
  expect_error(read("1 2 3 0.5\n1 2 4 0.5\n", "a.ptx"), ErrorCode::kInvalid, "no PTX");
}

}  // namespace
}  // namespace camloc::mapping
