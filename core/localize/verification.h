// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Is this hypothesis a pose? An inlier count alone does not tell: on real frames of another place 16 of 16 hypotheses had
// 15 inliers or more. Every test below must pass; the first that fails is the reason the caller hears.
#pragma once

#include "core/localize/localization.h"
#include "core/localize/pose_estimator.h"

namespace camloc {

struct VerificationOptions {
  std::uint32_t min_features = 40;
  std::uint32_t min_inliers = 20;           ///< of a global fix that measured depth confirms
  std::uint32_t min_inliers_no_depth = 40;  ///< of a global fix where depth says nothing
  std::uint32_t min_tracked_inliers = 15;   ///< where the pose was predicted
  double min_inlier_ratio = 0.4;
  double min_spread = 0.1;  ///< of the image's cells
  double min_margin = 0.4;  ///< against the strongest rival place
  /// Below this many inliers measured depth must confirm the pose; from here on it must only not contradict it: depth that
  /// lags behind the image in a fast turn agrees for half of the pixels and the pose is still right.
  std::uint32_t strong_inliers = 60;
  std::uint32_t min_depth_samples = 12;  ///< fewer inliers with depth say nothing
  double min_depth_agreement = 0.4;      ///< of the inliers
  double min_depth_agreement_thin = 0.6;
  std::uint32_t min_map_depth_samples = 30;
  double min_map_depth_agreement = 0.5;  ///< of all landmarks in view
  /// On held-out real frames right poses with few inliers had 0.84 and more; poses half a metre off on a repeated texture,
  /// with up to 53 inliers, 0.64 to 0.75; one 1.3 m off 0.17.
  double min_map_depth_agreement_thin = 0.8;
  double max_focal_deviation = 0.05;  ///< |focal_scale - 1|
  double focal_deviation_sigmas = 4.0;
  double max_position_sigma_m = 0.15;
  double max_rotation_sigma_rad = 0.06;
};

/// `margin` is 1 for a tracked hypothesis. kNone means verified.
[[nodiscard]] Reason verify(const PoseHypothesis& hypothesis, double margin, bool is_tracked, const VerificationOptions& options);

/// Does the focal length that the matches ask for contradict the assumed one?
[[nodiscard]] bool is_calibration_mismatch(const PoseHypothesis& hypothesis, const VerificationOptions& options);

/// 0..100 for people and for thresholds of subscribers: how far above the limits of verification a pose is.
[[nodiscard]] int quality_of(const PoseHypothesis& hypothesis, double margin);

}  // namespace camloc
