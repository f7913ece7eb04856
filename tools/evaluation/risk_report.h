// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Were the promises kept? Risk promised against risk observed, how often ellipsoids and protection levels hold, what a threshold on the
// risk costs in availability, and NEES by the number of inliers.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "tools/evaluation/judged_poses.h"

namespace camloc::tools {

/// A bin with fewer poses says nothing.
inline constexpr std::uint64_t kMinPosesOfBin = 30;

/// Poses by their promised risk, LOCALIZED and refused candidates alike: only the latter are wrong often enough to tell.
struct RiskBin {
  double from = 0, to = 1;
  std::uint64_t num_poses = 0, num_misleading = 0;
  std::uint64_t num_localized = 0, num_localized_misleading = 0;  ///< of those
  double promised = 0;                                            ///< mean over the poses
  [[nodiscard]] double observed() const {
    return num_poses == 0 ? 0 : static_cast<double>(num_misleading) / static_cast<double>(num_poses);
  }
};

/// Shares of LOCALIZED poses inside what was promised.
struct Coverage {
  std::uint64_t num_poses = 0;
  double ellipsoid_95 = 0, protection_95 = 0, protection_999 = 0;  ///< protection: position and rotation both
  double position_999 = 0, rotation_999 = 0;
};

/// LOCALIZED poses with a promised risk of at most `max_risk`.
struct RiskThreshold {
  double max_risk = 1;
  double availability = 0;  ///< share of all frames
  std::uint64_t num_misleading = 0;
  double misleading_share = 0;  ///< of those poses
};

struct NeesBin {
  std::uint32_t min_inliers = 0, max_inliers = 0;
  std::uint64_t num_poses = 0;
  double mean = 0, ellipsoid_95 = 0;
};

struct RiskReport {
  std::uint64_t num_frames = 0, num_localized = 0;
  std::vector<RiskBin> bins;
  Coverage all, hardest;  ///< hardest: the quarter with the fewest inliers
  std::vector<RiskThreshold> thresholds;
  std::vector<NeesBin> nees;  ///< eight bins of equally many poses
};

[[nodiscard]] RiskReport make_risk_report(std::span<const JudgedPose> poses, std::uint64_t num_frames);

}  // namespace camloc::tools
