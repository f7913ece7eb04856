// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Polygon files with everything that PLY allows, and broken ones.
#include <gtest/gtest.h>

#include <string>

#include "tests/mapping/cloud_bytes.h"

namespace camloc::mapping {
namespace {

std::string binary_ply(bool is_big_endian, std::uint64_t count = 3) {
  std::string bytes =
      std::string("ply\nformat ") + (is_big_endian ? "binary_big_endian" : "binary_little_endian") +
      " 1.0\ncomment made by hand\nelement camera 1\nproperty list uchar int ids\nproperty float f\nelement vertex " +
      std::to_string(count) +
      "\nproperty uchar red\nproperty double x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int "
      "vertex_indices\nend_header\n";
  put<std::uint8_t>(&bytes, 2);
  put<std::int32_t>(&bytes, 7, is_big_endian);
  put<std::int32_t>(&bytes, 8, is_big_endian);
  put<float>(&bytes, 525, is_big_endian);
  for (const Eigen::Vector3d& p : kPoints) {
    put<std::uint8_t>(&bytes, 200);
    put<double>(&bytes, p.x(), is_big_endian);
    put<float>(&bytes, static_cast<float>(p.y()), is_big_endian);
    put<float>(&bytes, static_cast<float>(p.z()), is_big_endian);
  }
  put<std::uint8_t>(&bytes, 3);
  for (const int i : {0, 1, 2}) put<std::int32_t>(&bytes, i, is_big_endian);
  return bytes;
}

const char* const kAsciiPly =
    "ply\r\nformat ascii 1.0\r\nelement vertex 3\r\nproperty float z\r\nproperty list uchar int tags\r\nproperty float "
    "x\r\nproperty float y\r\n"
    "end_header\r\n0.5 2 7 8 1.5 -2.25\r\n8 0 2 4\r\n1 1 9 -3.125 0\r\n";

TEST(CloudPly, ReadsPly) {
  expect_points(read(binary_ply(false), "a.ply"), kPoints);
  expect_points(read(binary_ply(true), "a.ply"), kPoints);
  expect_points(read(kAsciiPly, "a.ply"), kPoints);
}

TEST(CloudPly, ReadsPlyWithListsInItsVertices) {
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty list uchar short tags\nproperty float x\nproperty float "
      "y\nproperty float z\nend_header\n";
  for (int i = 0; i < 2; ++i) {
    put<std::uint8_t>(&bytes, static_cast<std::uint8_t>(3 * i));
    for (int k = 0; k < 3 * i; ++k) put<std::int16_t>(&bytes, 5);
    for (int axis = 0; axis < 3; ++axis) put<float>(&bytes, static_cast<float>(kPoints[static_cast<std::size_t>(i)][axis]));
  }
  expect_points(read(bytes, "a.ply"), {kPoints[0], kPoints[1]});
}

TEST(CloudPly, RefusesBadPly) {
  const std::string good = binary_ply(false);
  expect_error(read(good.substr(0, good.size() - 20), "a.ply"), ErrorCode::kCorrupt, "truncated");
  expect_error(read(binary_ply(false, 1000000), "a.ply"), ErrorCode::kCorrupt, "promises 1000000");
  expect_error(read(binary_ply(false, std::uint64_t{1} << 62), "a.ply"), ErrorCode::kCorrupt, "do not fit");
  expect_error(read("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n1 2\n", "a.ply"),
               ErrorCode::kCorrupt, "x, y and z");
  expect_error(read("ply\nformat ascii 1.0\nelement vertex -4\nend_header\n", "a.ply"), ErrorCode::kInvalid, "a.ply:3");
  expect_error(read("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x", "a.ply"), ErrorCode::kCorrupt, "no end");
  std::string ascii = kAsciiPly;
  ascii.replace(ascii.find("8 0 2 4"), 7, "8 0 2 q");
  expect_error(read(ascii, "a.ply"), ErrorCode::kCorrupt, "vertex 1");
}

}  // namespace
}  // namespace camloc::mapping
