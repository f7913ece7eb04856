// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The records of `camloc localize --json` beside the truth: what each frame promised and what became of it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/localize/integrity.h"
#include "tools/evaluation/trajectory_error.h"

namespace camloc::tools {

struct JudgedPose {
  bool is_localized = false;  ///< otherwise COARSE: a candidate that was refused
  std::uint32_t num_inliers = 0;
  RiskFeatures features{};
  double integrity_risk = 1;  ///< promised
  Protection protection;
  double error_m = 0, error_rad = 0;
  bool is_misleading = false;         ///< farther off than kMisleading
  double nees = 0;                    ///< 6 degrees of freedom; of COARSE poses meaningless
  double sigma_m = 0, sigma_rad = 0;  ///< of the published covariance, worst axis
};

struct JudgedRun {
  std::uint64_t num_frames = 0;   ///< all that were tried
  std::vector<JudgedPose> poses;  ///< LOCALIZED and COARSE ones with a reference pose, in order
};

/// kInvalid, with the file's name, for what is no such file or has no pose at the times of the reference. `T_reference_estimate` is
/// applied to the poses first.
[[nodiscard]] Result<JudgedRun> judge_records(const std::string& path, const ReferencePose& reference, const Rigid3& T_reference_estimate);

}  // namespace camloc::tools
