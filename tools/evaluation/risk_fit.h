// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Where the tables of core/localize/integrity.cc come from: poses with a truth, those that were refused included, because the others
// are hardly ever wrong.
#pragma once

#include <array>
#include <span>

#include "tools/evaluation/judged_poses.h"

namespace camloc::tools {

struct RiskFit {
  std::array<double, kNumRiskFeatures + 1> weights{};  ///< see risk_weights(); all but the constant at least 0
  std::uint64_t num_poses = 0, num_faults = 0;
  double position_sigmas_95 = 0, position_sigmas_999 = 0;  ///< quantiles of the error of LOCALIZED poses, in sigmas of the worst axis
  double rotation_sigmas_95 = 0, rotation_sigmas_999 = 0;
};

/// Logistic regression of "misleads" on the features (maximum likelihood, weights kept at 0 or above, a weak prior on their size),
/// coordinate by coordinate. Deterministic.
[[nodiscard]] RiskFit fit_risk(std::span<const JudgedPose> poses);

}  // namespace camloc::tools
