// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Three points as bytes of a cloud file, and whether they come out of it.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <sstream>
#include <string>
#include <vector>

#include "tools/mapping/cloud/point_cloud.h"

namespace camloc::mapping {

inline const std::vector<Eigen::Vector3d> kPoints = {{1.5, -2.25, 0.5}, {2, 4, 8}, {-3.125, 0, 1}};

template <typename T>
void put(std::string* bytes, T value, bool is_big_endian = false) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  if (is_big_endian) std::reverse(raw, raw + sizeof(T));
  bytes->append(raw, sizeof(T));
}

template <typename T>
void put_at(std::string* bytes, std::size_t offset, T value) {
  std::memcpy(bytes->data() + offset, &value, sizeof(T));
}

inline Result<PointCloud> read(const std::string& bytes, const std::string& name, const CloudOptions& options = {}) {
  std::istringstream stream(bytes);
  return read_cloud(stream, name, options);
}

/// The points are there, in any order, to `tolerance_m`.
inline void expect_points(const Result<PointCloud>& cloud, std::vector<Eigen::Vector3d> points, double tolerance_m = 1e-6) {
  ASSERT_TRUE(cloud.is_ok()) << cloud.status().message();
  ASSERT_EQ(cloud.value().points_m.size(), points.size());
  for (const Eigen::Vector3d& expected : points) {
    double nearest = 1e9;
    for (const Eigen::Vector3f& p : cloud.value().points_m)
      nearest = std::min(nearest, (cloud.value().origin_m + p.cast<double>() - expected).norm());
    EXPECT_LT(nearest, tolerance_m) << expected.transpose();
  }
}

inline void expect_error(const Result<PointCloud>& cloud, ErrorCode code, const std::string& part) {
  ASSERT_FALSE(cloud.is_ok());
  EXPECT_EQ(cloud.status().code(), code) << cloud.status().message();
  EXPECT_NE(cloud.status().message().find(part), std::string::npos) << cloud.status().message();
  EXPECT_EQ(cloud.status().message().find('\n'), std::string::npos);
}

}  // namespace camloc::mapping
