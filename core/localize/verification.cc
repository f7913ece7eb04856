// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/localize/verification.h"

#include <algorithm>
#include <cmath>

namespace camloc {

namespace {

bool contradicts_depth(const PoseHypothesis& hypothesis, const VerificationOptions& options) {
  const bool is_thin = hypothesis.num_inliers < options.strong_inliers;
  const double min_inliers_agree = is_thin ? options.min_depth_agreement_thin : options.min_depth_agreement;
  const double min_map_agrees = is_thin ? options.min_map_depth_agreement_thin : options.min_map_depth_agreement;
  return (hypothesis.num_with_depth >= options.min_depth_samples && hypothesis.depth_agreement < min_inliers_agree) ||
         (hypothesis.num_map_depth >= options.min_map_depth_samples && hypothesis.map_depth_agreement < min_map_agrees);
}

}  // namespace

Reason verify(const PoseHypothesis& hypothesis, double margin, bool is_tracked, const VerificationOptions& options) {
  const bool has_map_depth = hypothesis.num_map_depth >= options.min_map_depth_samples;
  const std::uint32_t min_inliers = is_tracked      ? options.min_tracked_inliers
                                    : has_map_depth ? options.min_inliers
                                                    : options.min_inliers_no_depth;

  if (hypothesis.num_matches < min_inliers) return Reason::kFewMatches;
  if (!hypothesis.is_found) return Reason::kFewInliers;
  if (is_calibration_mismatch(hypothesis, options)) return Reason::kCalibrationMismatch;
  if (hypothesis.num_inliers < min_inliers) return Reason::kFewInliers;
  if (hypothesis.inlier_ratio() < options.min_inlier_ratio) return Reason::kLowInlierRatio;
  if (hypothesis.spread < options.min_spread) return Reason::kPoorSpread;
  if (margin < options.min_margin) return Reason::kAmbiguous;
  if (contradicts_depth(hypothesis, options)) return Reason::kDepthInconsistent;
  const Vector6d variance = hypothesis.covariance.diagonal();
  if (!(variance.head<3>().maxCoeff() < options.max_position_sigma_m * options.max_position_sigma_m)) return Reason::kUncertain;
  if (!(variance.tail<3>().maxCoeff() < options.max_rotation_sigma_rad * options.max_rotation_sigma_rad)) return Reason::kUncertain;
  return Reason::kNone;
}

bool is_calibration_mismatch(const PoseHypothesis& hypothesis, const VerificationOptions& options) {
  if (!hypothesis.has_focal_scale) return false;
  const double deviation = std::abs(hypothesis.focal_scale - 1.0);
  return deviation > options.max_focal_deviation && deviation > options.focal_deviation_sigmas * hypothesis.focal_scale_sigma;
}

int quality_of(const PoseHypothesis& hypothesis, double margin) {
  const double count = std::min(1.0, hypothesis.num_inliers / 200.0);
  const double cover = std::min(1.0, hypothesis.spread / 0.6);
  const double quality = 100.0 * std::cbrt(count * cover * hypothesis.inlier_ratio()) * std::clamp(margin, 0.0, 1.0);
  return std::clamp(static_cast<int>(std::lround(quality)), 0, 100);
}

}  // namespace camloc
