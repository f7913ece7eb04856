// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/frame_registration.h"

namespace camloc {
namespace {

constexpr RivalDistance kAnotherPlace{.position_m = 0.5, .rotation_rad = 0.35};
constexpr double kMaxRivalShare = 0.6;  // inliers of another place, as a share of the best

Registration registered(const PoseEvidence& evidence, const LandmarkSet& landmarks, const PoseSolver& solver) {
  Registration result{evidence, {}};
  if (!evidence.is_found) return result;
  result.inliers.reserve(evidence.num_inliers);
  solver.append_inliers(&result.inliers);
  for (LandmarkObservation& inlier : result.inliers) inlier.landmark = landmarks.id(inlier.landmark);
  return result;
}

}  // namespace

PoseSolverOptions mapping_solver_options(int max_features, bool use_depth) {
  PoseSolverOptions options;
  options.max_features = max_features;
  options.candidate_ratio = 0.9;
  options.ransac_iterations = 300;
  options.max_error_px = 4.0;
  options.guided_radius_px = 6;
  options.min_inliers = 20;
  options.use_depth = use_depth;
  options.landmark_sigma_px = kFreshLandmarkSigmaPx;
  options.gathers_evidence = false;
  return options;
}

Registration register_near(const FrameFeatures& view, const Rigid3& T_map_camera_predicted, float radius_px, std::uint64_t seed,
                           LandmarkSet* landmarks, PoseSolver* solver) {
  solver->begin(view);
  const auto matches = solver->search_by_projection(landmarks, T_map_camera_predicted, radius_px);
  return registered(solver->solve_and_refine(landmarks, matches, seed), *landmarks, *solver);
}

Registration register_anywhere(const FrameFeatures& view, std::uint64_t seed, LandmarkSet* landmarks, PoseSolver* solver) {
  solver->begin(view);
  solver->candidates().clear();
  landmarks->append_candidates(&solver->candidates());
  return registered(solver->solve_and_refine(landmarks, solver->match_candidates(), seed), *landmarks, *solver);
}

bool is_convincing(const PoseEvidence& found, const PlaceLimits& limits) {
  return found.is_found && found.num_inliers >= limits.min_inliers && found.inlier_ratio() >= limits.min_inlier_ratio &&
         found.depth_agreement >= limits.min_depth_agreement && found.spread >= limits.min_spread;
}

bool is_strong_rival(const PoseEvidence& other, const PoseEvidence& best) {
  return are_rivals(other.T_map_camera, best.T_map_camera, kAnotherPlace) && other.num_inliers > kMaxRivalShare * best.num_inliers;
}

}  // namespace camloc
