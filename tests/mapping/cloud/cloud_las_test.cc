// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Survey scans in LAS.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "tests/mapping/cloud_bytes.h"

namespace camloc::mapping {
namespace {

std::string las(int minor, int format, std::uint16_t record_bytes, std::uint64_t count) {
  std::string bytes(minor == 4 ? 375 : 227, '\0');
  std::copy_n("LASF", 4, bytes.data());
  bytes[24] = 1;
  bytes[25] = static_cast<char>(minor);
  bytes[104] = static_cast<char>(format);
  put_at(&bytes, 96, static_cast<std::uint32_t>(bytes.size()));
  put_at(&bytes, 105, record_bytes);
  put_at(&bytes, 107, static_cast<std::uint32_t>(minor == 4 ? 0 : count));
  if (minor == 4) put_at(&bytes, 247, count);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    put_at(&bytes, 131 + 8 * axis, 0.001);
    put_at(&bytes, 155 + 8 * axis, axis == 0 ? 500000.0 : axis == 1 ? 5400000.0 : 100.0);
  }
  for (const Eigen::Vector3d& p : kPoints) {
    std::string record(record_bytes, '\0');
    for (int axis = 0; axis < 3; ++axis)
      put_at(&record, static_cast<std::size_t>(4 * axis), static_cast<std::int32_t>(std::lround(1000 * p[axis])));
    bytes += record;
  }
  return bytes;
}

TEST(CloudLas, ReadsLasWithSurveyCoordinates) {
  std::vector<Eigen::Vector3d> expected;
  for (const Eigen::Vector3d& p : kPoints) expected.push_back(p + Eigen::Vector3d(500000, 5400000, 100));
  expect_points(read(las(2, 0, 20, 3), "a.las"), expected, 1e-5);
  expect_points(read(las(2, 3, 40, 3), "a.las"), expected, 1e-5);
  expect_points(read(las(4, 10, 67, 3), "a.las"), expected, 1e-5);
  std::string withheld = las(4, 6, 30, 3);
  withheld[375 + 30 + 15] = 4;
  const auto cloud = read(withheld, "a.las");
  expect_points(cloud, {expected[0], expected[2]}, 1e-5);
  EXPECT_EQ(cloud.value().num_invalid, 1U);
}

TEST(CloudLas, RefusesBadLas) {
  expect_error(read(las(2, 0, 20, 4), "a.las"), ErrorCode::kCorrupt, "promises 4");
  expect_error(read(las(2, 3, 20, 3), "a.las"), ErrorCode::kCorrupt, "too short");
  expect_error(read(las(2, 0x83, 34, 3), "a.las"), ErrorCode::kUnsupported, "pdal");
  expect_error(read(las(2, 11, 80, 3), "a.las"), ErrorCode::kUnsupported, "point format 11");
  expect_error(read(las(5, 0, 20, 3), "a.las"), ErrorCode::kUnsupported, "LAS 1.5");
  expect_error(read(las(2, 0, 20, 3).substr(0, 200), "a.las"), ErrorCode::kCorrupt, "227");
  std::string no_scale = las(2, 0, 20, 3);
  put_at(&no_scale, 139, std::numeric_limits<double>::quiet_NaN());
  expect_error(read(no_scale, "a.las"), ErrorCode::kCorrupt, "scale");
}

}  // namespace
}  // namespace camloc::mapping
