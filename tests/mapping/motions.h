// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Motions in degrees, and whether two of them are the same.
#pragma once

#include <gtest/gtest.h>

#include <numbers>
#include <vector>

#include "core/geometry/rigid3.h"

namespace camloc::mapping {

inline constexpr double kDegree = std::numbers::pi / 180;

inline Rigid3 motion(const Eigen::Vector3d& rotation_deg, const Eigen::Vector3d& translation_m) {
  return {exp_so3(kDegree * rotation_deg), translation_m};
}

/// Landmarks in a map whose frame differs from the cloud's by `T_cloud_map`.
inline std::vector<Eigen::Vector3d> in_map(const std::vector<Eigen::Vector3d>& landmarks, const Rigid3& T_cloud_map) {
  std::vector<Eigen::Vector3d> result;
  for (const Eigen::Vector3d& p : landmarks) result.push_back(T_cloud_map.inverse() * p);
  return result;
}

inline void expect_near(const Rigid3& T, const Rigid3& expected, double tolerance_m, double tolerance_deg) {
  EXPECT_LT((T * Eigen::Vector3d(4, 2, 1) - expected * Eigen::Vector3d(4, 2, 1)).norm(), tolerance_m);
  EXPECT_LT(rotation_distance_rad(T.rotation, expected.rotation), tolerance_deg * kDegree);
}

}  // namespace camloc::mapping
