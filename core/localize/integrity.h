// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What a pose is worth, as numbers that can be checked: the probability that it misleads, and radii that hold its error. Both are
// promises about rates, calibrated on recordings with a reference (see the tables in integrity.cc) and checked on others by
// `camloc eval --records`. The terms are those of navigation (Walter and Enge, "Weighted RAIM for precision approach", 1995): a
// protection level bounds the error of a pose without a fault; that there is a fault, the wrong place, is the integrity risk.
#pragma once

#include <array>
#include <span>

#include "core/geometry/rigid3.h"
#include "core/registration/rivals.h"

namespace camloc {

/// A pose farther off than this misleads.
inline constexpr double kMisleadingPosition_m = 0.25, kMisleadingRotation_rad = 0.17453292519943295;  // 10 deg

/// What speaks for a pose, each from 0 (nothing) to 1 (all one can ask for).
enum class RiskFeature { kInliers, kInlierRatio, kSpread, kMargin, kLead, kDepthAgreement, kMapDepthAgreement, kTracked };
inline constexpr std::size_t kNumRiskFeatures = 8;
using RiskFeatures = std::array<double, kNumRiskFeatures>;
[[nodiscard]] RiskFeatures risk_features(const PoseEvidence& evidence, const Standing& standing, bool is_tracked);

/// A pose is at the wrong place with probability 1 / (1 + exp(weight_0 + sum of weights times features)); weights are not negative, so
/// that more evidence is never worth less.
struct RiskWeight {
  const char* name;
  double weight;
};
[[nodiscard]] std::span<const RiskWeight> risk_weights();  ///< the constant first, then in the order of RiskFeature
[[nodiscard]] double fault_probability(const RiskFeatures& features);

/// Probability that the position is off by more than 25 cm or the rotation by more than 10 deg: a fault, or an error in the far tail of
/// `covariance` (of pose_error(), all that is published). In (0, 1), never below what the calibration can support.
[[nodiscard]] double integrity_risk(const RiskFeatures& features, const Matrix6d& covariance);

struct ProtectionLevel {
  double position_m = 1e3, rotation_rad = 1e3;  ///< as good as infinite where there is no pose
};
/// Radii that hold the error of a pose at the right place in 95 and in 99.9 % of all poses.
struct Protection {
  ProtectionLevel p95, p999;
};
[[nodiscard]] Protection protection_of(const Matrix6d& covariance);

}  // namespace camloc
