// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The equations over the poses, as terms add to them: of a pose graph, or what remains of a bundle adjustment once the landmarks
// are eliminated.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/optimize/block_system.h"

namespace camloc {

/// In place of a row, for a pose that is held.
inline constexpr std::uint32_t kFixedPose = 0xffffffff;

struct PoseEquations {
  BlockSystem system;
  std::vector<Vector6d> diagonal;  ///< of the terms' own blocks, before an elimination: what Marquardt's damping needs

  explicit PoseEquations(std::uint32_t num_poses) : system(num_poses), diagonal(num_poses, Vector6d::Zero()) {}  ///< dense
  explicit PoseEquations(const BlockPattern& pattern) : system(pattern), diagonal(pattern.num_blocks(), Vector6d::Zero()) {}

  void set_zero() {
    system.set_zero();
    std::fill(diagonal.begin(), diagonal.end(), Vector6d::Zero());
  }
};

/// The row of each pose: those that are not fixed, numbered in their order.
[[nodiscard]] inline std::vector<std::uint32_t> rows_of_poses(const std::vector<std::uint8_t>& is_fixed) {
  std::vector<std::uint32_t> rows;
  std::uint32_t num_free = 0;
  for (const std::uint8_t fixed : is_fixed) rows.push_back(fixed != 0 ? kFixedPose : num_free++);
  return rows;
}

[[nodiscard]] inline std::uint32_t num_free_poses(const std::vector<std::uint32_t>& rows) {
  return static_cast<std::uint32_t>(std::count_if(rows.begin(), rows.end(), [](std::uint32_t row) { return row != kFixedPose; }));
}

}  // namespace camloc
