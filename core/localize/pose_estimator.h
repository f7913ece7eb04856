// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// From matches to a pose hypothesis and its figures: PnP-RANSAC, refinement with depth, and a guided second look at the
// map around the pose that was found.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/features/matcher.h"
#include "core/geometry/correspondences.h"
#include "core/geometry/pnp_ransac.h"
#include "core/geometry/pose_refinement.h"
#include "core/localize/local_landmarks.h"
#include "core/localize/observations.h"
#include "core/localize/stage_timer.h"
#include "core/map/map_view.h"

namespace camloc {

/// A pose and what speaks for it. Verification decides what it is worth.
struct PoseHypothesis {
  bool is_found = false;
  Rigid3 T_map_camera;
  Matrix6d covariance = Matrix6d::Zero();
  std::uint32_t num_matches = 0;  ///< of the guided look around the pose
  std::uint32_t num_inliers = 0;
  std::uint32_t num_visible = 0;  ///< landmarks that should be in view, as far as they were projected
  double spread = 0;              ///< share of the image's 8 x 6 cells that hold an inlier
  std::uint32_t num_with_depth = 0;
  double depth_agreement = 1;       ///< share of inliers with depth whose depth agrees
  std::uint32_t num_map_depth = 0;  ///< landmarks in view whose pixel has a measured depth and that nothing hides
  double map_depth_agreement = 1;   ///< share of those that lie on the measured surface; the others are seen through
  double rms_px = 0;
  double focal_scale = 1;  ///< true / assumed focal length that fits these matches best
  double focal_scale_sigma = 1;
  bool has_focal_scale = false;

  [[nodiscard]] double inlier_ratio() const { return num_matches == 0 ? 0.0 : static_cast<double>(num_inliers) / num_matches; }
};

struct PoseEstimatorOptions {
  PnpRansacOptions ransac;
  PoseRefinementOptions refinement;
  GuidedMatcherOptions guided;
  LocalLandmarksOptions local;
  int max_ransac_pairs = 300;      ///< best matches by descriptor distance; worth more than any iteration count
  float guided_radius_px = 12.0F;  ///< window of the second look
};

/// Not thread-safe; allocates at construction only.
class PoseEstimator {
 public:
  PoseEstimator(const MapView& map, const RgbdCamera& camera, const OrbOptions& orb, const PoseEstimatorOptions& options,
                StageTimer* timer);

  /// Pose from matches with outliers, not yet looked at a second time. `seed` makes the sampling reproducible.
  /// Matches that fit `T_map_explained`, where given, are left out: what other pose do the remaining ones ask for?
  [[nodiscard]] PoseHypothesis from_matches(const FrameObservations& frame, std::span<const Match> matches, std::uint64_t seed,
                                            const Rigid3* T_map_explained = nullptr);
  /// Matches in windows around a predicted pose; valid until the next call.
  std::span<const Match> match_around(const FrameObservations& frame, const Rigid3& T_map_camera, float radius_px);
  /// Looks at the map again around a found pose, refines on all that fits, and gathers the figures for verification.
  [[nodiscard]] PoseHypothesis look_again(const FrameObservations& frame, const PoseHypothesis& hypothesis);

 private:
  void fill_pairs(const FrameObservations& frame, std::span<const Match> matches, const Rigid3* T_map_explained, std::size_t limit);
  [[nodiscard]] bool is_explained(const FrameObservations& frame, const Match& match, const Rigid3& T_map_camera) const;
  void summarize(const FrameObservations& frame, const PoseRefinementResult& refined, PoseHypothesis* hypothesis);
  [[nodiscard]] double inliers_per_patch(const FrameObservations& frame);
  void measure_focal_scale(PoseHypothesis* hypothesis);
  void measure_map_depth(const FrameObservations& frame, std::span<const ProjectedLandmark> visible, PoseHypothesis* hypothesis) const;

  const MapView* map_;
  Intrinsics color_;
  double focal_px_;
  PoseEstimatorOptions options_;
  LocalLandmarks local_;
  GuidedMatcher guided_;
  PnpRansac ransac_;
  Correspondences pairs_;
  std::vector<std::uint8_t> inlier_mask_;
  std::span<const ProjectedLandmark> visible_;  ///< of the last look
  std::vector<std::uint8_t> is_patch_seen_;     ///< one byte per kPatchPx square of the image
  StageTimer* timer_;
};

}  // namespace camloc
