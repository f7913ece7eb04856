// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Files of the Point Cloud Library in their three encodings.
#include <gtest/gtest.h>

#include <string>

#include "tests/mapping/cloud_bytes.h"

namespace camloc::mapping {
namespace {

std::string pcd(const std::string& data, const std::string& payload, int points = 3) {
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS rgb x y z\nSIZE 1 4 8 4\nTYPE U F F F\nCOUNT 3 1 1 "
         "1\nWIDTH " +
         std::to_string(points) + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + std::to_string(points) + "\nDATA " + data + "\n" +
         payload;
}

std::string pcd_records() {
  std::string bytes;
  for (const Eigen::Vector3d& p : kPoints) {
    bytes += "rgb";
    put<float>(&bytes, static_cast<float>(p.x()));
    put<double>(&bytes, p.y());
    put<float>(&bytes, static_cast<float>(p.z()));
  }
  return bytes;
}

/// Field by field; the colours as a back reference to themselves, the rest as literal runs.
std::string pcd_compressed() {
  std::string columns = "abcabcabc", packed = {2, 'a', 'b', 'c', static_cast<char>((4 << 5) | 0), 2};  // 6 bytes from 3 back
  std::string rest;
  for (const Eigen::Vector3d& p : kPoints) put<float>(&rest, static_cast<float>(p.x()));
  for (const Eigen::Vector3d& p : kPoints) put<double>(&rest, p.y());
  for (const Eigen::Vector3d& p : kPoints) put<float>(&rest, static_cast<float>(p.z()));
  for (std::size_t i = 0; i < rest.size(); i += 32) {
    const std::string run = rest.substr(i, 32);
    packed += static_cast<char>(run.size() - 1);
    packed += run;
  }
  std::string bytes;
  put<std::uint32_t>(&bytes, static_cast<std::uint32_t>(packed.size()));
  put<std::uint32_t>(&bytes, static_cast<std::uint32_t>(columns.size() + rest.size()));
  return bytes + packed;
}

TEST(CloudPcd, ReadsPcd) {
  expect_points(read(pcd("ascii", "1 2 3 1.5 -2.25 0.5\n1 2 3 2 4 8\n1 2 3 -3.125 0 1\n"), "a.pcd"), kPoints);
  expect_points(read(pcd("binary", pcd_records()), "a.pcd"), kPoints);
  expect_points(read(pcd("binary_compressed", pcd_compressed()), "a.pcd"), kPoints);
}

TEST(CloudPcd, RefusesBadPcd) {
  expect_error(read(pcd("binary", pcd_records(), 400), "a.pcd"), ErrorCode::kCorrupt, "promises 400");
  expect_error(read(pcd("ascii", "1 2 3 4 5 6\n"), "a.pcd"), ErrorCode::kCorrupt, "the file has 1");
  expect_error(read(pcd("ascii", "1 2 3 4\n"), "a.pcd"), ErrorCode::kCorrupt, "point 0");
  const std::string packed = pcd_compressed();
  expect_error(read(pcd("binary_compressed", packed.substr(0, 30)), "a.pcd"), ErrorCode::kCorrupt, "shorter");
  expect_error(read(pcd("binary_compressed", packed, 4), "a.pcd"), ErrorCode::kCorrupt, "not 4 points");
  std::string far_back = packed;
  far_back[13] = 120;  // refers to before the beginning
  expect_error(read(pcd("binary_compressed", far_back), "a.pcd"), ErrorCode::kCorrupt, "damaged");
  expect_error(read("VERSION 0.7\nFIELDS x y z\nSIZE 4 4\n", "a.pcd"), ErrorCode::kInvalid, "a.pcd:3");
  expect_error(read("VERSION 0.7\nFIELDS a b c\nDATA ascii\n", "a.pcd"), ErrorCode::kCorrupt, "x, y and z");
}

}  // namespace
}  // namespace camloc::mapping
