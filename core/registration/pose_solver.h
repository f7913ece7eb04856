// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The pose of a view among landmarks: the one engine behind localizing, tracking, closing loops, merging and judging maps.
//
//   matches   search_by_projection() around a predicted pose, or match_candidates() from descriptors alone
//   solve     PnP-RANSAC on the best matches, then refinement with depth
//   refine    guided refinement: another search around the pose that was found, refined on all that fits; gathers the evidence
//
// Nothing is decided here: what a pose is worth is for who asked.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/stage_timer.h"
#include "core/features/matcher.h"
#include "core/geometry/correspondences.h"
#include "core/geometry/pnp_ransac.h"
#include "core/geometry/pose_refinement.h"
#include "core/registration/feature_set.h"
#include "core/registration/frame_features.h"
#include "core/registration/image_cells.h"
#include "core/registration/keypoint_noise.h"
#include "core/registration/landmark_source.h"
#include "core/registration/pose_evidence.h"
#include "core/registration/shared_errors.h"

namespace camloc {

/// What its callers set; the rest are constants in pose_solver.cc.
struct PoseSolverOptions {
  int max_features = 1000;       ///< of a view
  int max_candidates = 4000;     ///< descriptors for match_candidates()
  double candidate_ratio = 1.0;  ///< best / best of another landmark; 1 = off
  int ransac_iterations = 600;   ///< P3P samples, always all of them
  int max_ransac_pairs = 300;    ///< best matches by descriptor distance; worth more than any iteration count
  double max_ransac_error_px = 5.0;
  double max_error_px = 5.0;       ///< of an inlier of the guided refinement
  float guided_radius_px = 12.0F;  ///< its search window
  int min_inliers = 0;             ///< a pose with fewer is not found (after RANSAC: half as many)
  bool use_depth = true;           ///< measured depth takes part in the pose
  float landmark_sigma_px = kMapLandmarkSigmaPx;
  /// Also asks what verification asks: a free focal length, landmarks seen through, inliers that share their errors. A tenth of the
  /// time.
  bool gathers_evidence = true;
  SharedErrors shared_errors;  ///< of the landmarks; part of the evidence
};

/// An inlier.
struct LandmarkObservation {
  std::uint32_t landmark = 0, feature = 0;  ///< in the source; in the view
};

/// Not thread-safe; allocates at construction only. The same input gives the same bits.
class PoseSolver {
 public:
  /// `timer` may be null.
  PoseSolver(const RgbdCamera& camera, const PyramidLevels& levels, const PoseSolverOptions& options, StageTimer* timer = nullptr);

  /// The view that all calls until the next begin() are about; it must stay as it is.
  void begin(const FrameFeatures& view, const MeasuredDepth& depth = {});

  /// Features within `radius_px` of where a camera there would see landmarks. Valid until the next call.
  std::span<const Match> search_by_projection(LandmarkSource* landmarks, const Rigid3& T_map_camera, float radius_px);
  /// To be filled by the caller, for match_candidates().
  [[nodiscard]] CandidateSet& candidates() { return candidates_; }
  /// Features against the candidates. Valid until the next call.
  std::span<const Match> match_candidates();

  /// Pose from matches with outliers; no guided refinement yet. `seed` makes the sampling reproducible. Matches that fit
  /// `T_map_explained`, where given, are left out: what other pose do the remaining ones ask for?
  [[nodiscard]] PoseEvidence solve(const LandmarkPositions& landmarks, std::span<const Match> matches, std::uint64_t seed,
                                   const Rigid3* T_map_explained = nullptr);
  [[nodiscard]] PoseEvidence refine(LandmarkSource* landmarks, const Rigid3& T_map_camera);
  /// solve(), and refine() what it found.
  [[nodiscard]] PoseEvidence solve_and_refine(LandmarkSource* landmarks, std::span<const Match> matches, std::uint64_t seed,
                                              const Rigid3* T_map_explained = nullptr);
  /// Of the last solve() or refine() that found a pose; one per inlier, in the order of the matches' rank. Appends.
  void append_inliers(std::vector<LandmarkObservation>* inliers) const;
  /// The features of those, and of those whose landmarks are not repeated.
  void explained_features(const LandmarkSource& landmarks, FeatureSet* all, FeatureSet* distinct) const;

 private:
  void fill_pairs(const LandmarkPositions& landmarks, std::span<const Match> matches, const Rigid3* T_map_explained, std::size_t limit);
  [[nodiscard]] bool is_explained(const Eigen::Vector3f& p_map, std::size_t feature, const Rigid3& T_map_camera) const;
  void summarize(const PoseRefinementResult& refined, PoseEvidence* evidence);
  [[nodiscard]] double inliers_per_patch();
  void count_distinct(const LandmarkSource& landmarks, PoseEvidence* evidence) const;
  [[nodiscard]] double thickness_m() const;
  void measure_focal_scale(PoseEvidence* evidence);
  void measure_map_depth(const LandmarkPositions& landmarks, std::span<const ProjectedLandmark> visible, PoseEvidence* evidence) const;
  [[nodiscard]] const Keypoint& keypoint_of_pair(std::size_t i) const {
    return view_->features.keypoints[static_cast<std::size_t>(pairs_.feature[i])];
  }
  void finish(Stage stage) {
    if (timer_ != nullptr) timer_->finish(stage);
  }

  RgbdCamera camera_;
  std::array<float, 256> pair_sigma_px_;  ///< per level
  double focal_px_;
  PoseSolverOptions options_;
  PoseRefinementOptions refinement_;
  const FrameFeatures* view_ = nullptr;
  MeasuredDepth depth_;
  FeatureGrid grid_;
  GuidedMatcher guided_;
  CandidateMatcher candidate_matcher_;
  CandidateSet candidates_;
  PnpRansac ransac_;
  Correspondences pairs_;
  std::vector<std::uint8_t> inlier_mask_;
  std::span<const ProjectedLandmark> visible_;  ///< of the last search
  std::vector<std::uint8_t> is_patch_seen_;     ///< one byte per square of the image
  StageTimer* timer_;
};

}  // namespace camloc
