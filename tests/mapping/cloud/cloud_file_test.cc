// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tests/mapping/cloud_bytes.h"
#include "tools/mapping/cloud/point_cloud.h"

namespace camloc::mapping {
namespace {

TEST(CloudFile, CountsWhatIsNotFinite) {
  const auto cloud = read("1 2 3\nnan nan nan\n4 inf 6\n7 8 9\n", "a.xyz");
  expect_points(cloud, {{1, 2, 3}, {7, 8, 9}});
  EXPECT_EQ(cloud.value().num_read, 4U);
  EXPECT_EQ(cloud.value().num_invalid, 2U);
  expect_error(read("nan nan nan\nnan nan nan\n", "a.xyz"), ErrorCode::kInvalid, "none of its 2 points");
}

TEST(CloudFile, SaysHowToConvertWhatItDoesNotRead) {
  expect_error(read("ASTM-E57 and so on", "a.e57"), ErrorCode::kUnsupported, "CloudCompare");
  expect_error(read("LASF and so on", "a.laz"), ErrorCode::kUnsupported, "pdal");
  expect_error(read(std::string("\x89PNG\0\1\2", 7), "a.png"), ErrorCode::kUnsupported, "PLY, PCD, LAS");
  expect_error(read("", "a.ply"), ErrorCode::kInvalid, "empty");
  expect_error(read_cloud("/no/such/file.ply", {}), ErrorCode::kNotFound, "no such file");
  expect_error(read_cloud("/", {}), ErrorCode::kInvalid, "folder");
}

/// A wall of 200 points in steps of 3 cm, in another place.
template <typename T>
std::string ply_wall(const char* type, double easting, double northing) {
  std::string bytes = std::string("ply\nformat binary_little_endian 1.0\nelement vertex 200\n") + "property " + type + " x\nproperty " +
                      type + " y\nproperty " + type + " z\nend_header\n";
  for (int i = 0; i < 200; ++i) {
    put(&bytes, static_cast<T>(easting + 0.031 * i));
    put(&bytes, static_cast<T>(northing + 0.017 * i));
    put(&bytes, static_cast<T>(521 + 0.011 * i));
  }
  return bytes;
}

TEST(CloudFile, RefusesCoordinatesInStairs) {
  expect_error(read(ply_wall<float>("float", 692345, 5334567), "a.ply"), ErrorCode::kInvalid, "steps of 0.5 m");
  // Written with double precision afterwards, what the floats had lost is not back.
  expect_error(read(ply_wall<float>("float", 40000, 300000), "a.ply"), ErrorCode::kInvalid, "around y = 300001");
  EXPECT_TRUE(read(ply_wall<double>("double", 692345, 5334567), "a.ply")->warnings.empty());
  EXPECT_TRUE(read(ply_wall<float>("float", 10, 20), "a.ply")->warnings.empty());
  const auto noted = read(ply_wall<float>("float", 40, 40000), "a.ply");
  ASSERT_TRUE(noted.is_ok()) << noted.status().message();
  ASSERT_EQ(noted->warnings.size(), 1U);
  EXPECT_NE(noted->warnings[0].find("steps of 0.0039 m"), std::string::npos) << noted->warnings[0];
}

TEST(CloudFile, TakesUnits) {
  CloudOptions options;
  options.unit_m = 0.001;
  const auto cloud = read("1500 -2250 500\n2000 4000 8000\n", "a.xyz", options);
  expect_points(cloud, {{1.5, -2.25, 0.5}, {2, 4, 8}});
}

}  // namespace
}  // namespace camloc::mapping
