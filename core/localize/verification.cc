// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/localize/verification.h"

#include <algorithm>
#include <cmath>

namespace camloc {

namespace {

bool contradicts_depth(const PoseEvidence& evidence, const LocalizerNumbers& numbers) {
  const bool is_thin = evidence.num_inliers < numbers.strong_inliers;
  const double min_inliers_agree = is_thin ? numbers.min_depth_agreement_thin : numbers.min_depth_agreement;
  const double min_map_agrees = is_thin ? numbers.min_map_depth_agreement_thin : numbers.min_map_depth_agreement;
  return (evidence.num_with_depth >= numbers.min_depth_samples && evidence.depth_agreement < min_inliers_agree) ||
         (evidence.num_map_depth >= numbers.min_map_depth_samples && evidence.map_depth_agreement < min_map_agrees);
}

/// Of the landmarks that should be seen too few are, or they are all on one plane, and not many: what is in the image may be something
/// like it that is not in the map at all. A mirrored room keeps what is symmetric of it.
bool is_something_else(const PoseEvidence& evidence, std::uint32_t min_inliers, const LocalizerNumbers& numbers) {
  const double found = evidence.found_share();
  if (found < numbers.min_found_share) return true;
  const bool is_flat = evidence.thickness_m < numbers.flat_thickness_m && found < numbers.flat_found_share;
  return is_flat && evidence.num_inliers < numbers.flat_inliers_factor * min_inliers;
}

}  // namespace

Reason verify(const PoseEvidence& evidence, const Standing& standing, bool is_tracked, const LocalizerNumbers& numbers) {
  const bool has_map_depth = evidence.num_map_depth >= numbers.min_map_depth_samples;
  const std::uint32_t min_inliers = is_tracked      ? numbers.min_tracked_inliers
                                    : has_map_depth ? numbers.min_inliers
                                                    : numbers.min_inliers_no_depth;

  if (evidence.num_matches < min_inliers) return Reason::kFewMatches;
  if (!evidence.is_found) return Reason::kFewInliers;
  if (is_calibration_mismatch(evidence, numbers)) return Reason::kCalibrationMismatch;
  if (evidence.num_inliers < min_inliers) return Reason::kFewInliers;
  if (!is_tracked && is_something_else(evidence, min_inliers, numbers)) return Reason::kFewInliers;
  if (evidence.inlier_ratio() < numbers.min_inlier_ratio) return Reason::kLowInlierRatio;
  if (evidence.spread < numbers.min_spread) return Reason::kPoorSpread;
  if (standing.margin < numbers.min_margin || standing.lead < numbers.min_lead) return Reason::kAmbiguous;
  if (contradicts_depth(evidence, numbers)) return Reason::kDepthInconsistent;
  const Vector6d variance = evidence.covariance.diagonal();
  if (!(variance.head<3>().maxCoeff() < numbers.max_position_sigma_m * numbers.max_position_sigma_m)) return Reason::kUncertain;
  if (!(variance.tail<3>().maxCoeff() < numbers.max_rotation_sigma_rad * numbers.max_rotation_sigma_rad)) return Reason::kUncertain;
  return Reason::kNone;
}

bool is_calibration_mismatch(const PoseEvidence& evidence, const LocalizerNumbers& numbers) {
  if (!evidence.has_focal_scale) return false;
  const double deviation = std::abs(evidence.focal_scale - 1.0);
  return deviation > numbers.max_focal_deviation && deviation > numbers.focal_deviation_sigmas * evidence.focal_scale_sigma;
}

int quality_of(const PoseEvidence& evidence, double margin) {
  const double count = std::min(1.0, evidence.num_inliers / 200.0);
  const double cover = std::min(1.0, evidence.spread / 0.6);
  const double quality = 100.0 * std::cbrt(count * cover * evidence.inlier_ratio()) * std::clamp(margin, 0.0, 1.0);
  return std::clamp(static_cast<int>(std::lround(quality)), 0, 100);
}

}  // namespace camloc
