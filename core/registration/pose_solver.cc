// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Read solve() and refine() first: both turn matches into pairs of a feature and a landmark, refine a pose on the pairs, and sum up
// what the inliers say. The measurements behind that are below, one function each.
#include "core/registration/pose_solver.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace camloc {
namespace {

constexpr int kMaxDistance = 64;                 // of 256 bits, for a match
constexpr double kGuidedRatio = 0.9;             // best / second best feature in a window
constexpr double kMaxRelativeDepthError = 0.15;  // of a pair in RANSAC; with more it is an outlier
/// The focal length is fitted to pairs this much farther off than inliers: a wrong one moves them.
constexpr double kFocalReach = 3.0;
/// A match this many inlier thresholds from a pose still belongs to it.
constexpr double kExplainedReach = 2.0;
constexpr int kMinPairs = 6;
/// Pairs closer than this in the image share their errors.
constexpr int kPatchPx = 16;
/// Landmarks whose depth is compared with the image, about; and how far they may be off besides noise, of their depth.
constexpr std::size_t kMapDepthSamples = 300;
constexpr double kMapDepthTolerance = 0.03;

int patch_count(int pixels) { return pixels / kPatchPx + 1; }

PnpRansacOptions ransac_options(const PoseSolverOptions& options) {
  PnpRansacOptions ransac;
  ransac.iterations = options.ransac_iterations;
  ransac.max_error_px = options.max_ransac_error_px;
  ransac.max_relative_depth_error = options.use_depth ? kMaxRelativeDepthError : 0;
  ransac.max_pairs = options.max_ransac_pairs;
  return ransac;
}

}  // namespace

PoseSolver::PoseSolver(const RgbdCamera& camera, const PyramidLevels& levels, const PoseSolverOptions& options, StageTimer* timer)
    : camera_(camera),
      focal_px_(camera.color.mean_focal_px()),
      options_(options),
      grid_(camera.color.width, camera.color.height, options.max_features),
      guided_({.max_distance = kMaxDistance, .max_ratio = kGuidedRatio}, options.max_features),
      candidate_matcher_({.max_distance = kMaxDistance, .max_ratio = options.candidate_ratio}, options.max_features,
                         static_cast<std::size_t>(options.max_candidates)),
      candidates_(static_cast<std::size_t>(options.max_candidates)),
      ransac_(ransac_options(options)),
      pairs_(static_cast<std::size_t>(options.max_features)),
      inlier_mask_(static_cast<std::size_t>(options.max_features)),
      is_patch_seen_(static_cast<std::size_t>(patch_count(camera.color.width) * patch_count(camera.color.height))),
      timer_(timer) {
  for (std::size_t level = 0; level < pair_sigma_px_.size(); ++level)
    pair_sigma_px_[level] = pair_sigma_px(levels.scale(static_cast<std::uint8_t>(level)), options.landmark_sigma_px);
  refinement_.depth_noise = camera.depth_noise;
  refinement_.use_depth = options.use_depth;
}

void PoseSolver::begin(const FrameFeatures& view, const MeasuredDepth& depth) {
  view_ = &view;
  depth_ = depth;
  grid_.assign(view.features.keypoints);
}

std::span<const Match> PoseSolver::search_by_projection(LandmarkSource* landmarks, const Rigid3& T_map_camera, float radius_px) {
  visible_ = landmarks->project(T_map_camera, radius_px);
  const auto matches = guided_.match(view_->features, grid_, visible_, landmarks->descriptors());
  finish(Stage::kMatch);
  return matches;
}

std::span<const Match> PoseSolver::match_candidates() {
  const auto matches = candidate_matcher_.match(view_->features, candidates_);
  finish(Stage::kMatch);
  return matches;
}

PoseEvidence PoseSolver::solve(const LandmarkPositions& landmarks, std::span<const Match> matches, std::uint64_t seed,
                               const Rigid3* T_map_explained) {
  PoseEvidence evidence;
  evidence.num_matches = static_cast<std::uint32_t>(matches.size());
  fill_pairs(landmarks, matches, T_map_explained, static_cast<std::size_t>(options_.max_ransac_pairs));
  const PnpRansacResult found = ransac_.estimate(pairs_, focal_px_, seed);
  if (found.is_found && found.num_inliers >= options_.min_inliers / 2) {
    refinement_.max_error_px = options_.max_ransac_error_px;
    const PoseRefinementResult refined = refine_pose(pairs_, found.T_map_camera, focal_px_, refinement_, &inlier_mask_);
    if (refined.is_converged) summarize(refined, &evidence);
  }
  finish(Stage::kEstimate);
  return evidence;
}

PoseEvidence PoseSolver::refine(LandmarkSource* landmarks, const Rigid3& T_map_camera) {
  PoseEvidence evidence;
  const auto matches = search_by_projection(landmarks, T_map_camera, options_.guided_radius_px);
  evidence.num_matches = static_cast<std::uint32_t>(matches.size());
  evidence.num_visible = static_cast<std::uint32_t>(visible_.size());
  fill_pairs(*landmarks, matches, nullptr, pairs_.capacity());
  if (pairs_.size() < kMinPairs) return evidence;
  refinement_.max_error_px = options_.max_error_px;
  const PoseRefinementResult refined = refine_pose(pairs_, T_map_camera, focal_px_, refinement_, &inlier_mask_);
  if (refined.is_converged && refined.num_inliers >= options_.min_inliers) {
    summarize(refined, &evidence);
    if (options_.gathers_evidence) {
      evidence.shared_covariance = shared_error_covariance(
          pairs_, inlier_mask_, refined.T_map_camera, {focal_px_, refinement_.depth_noise, options_.use_depth, options_.shared_errors});
      count_distinct(*landmarks, &evidence);
      evidence.thickness_m = thickness_m();
      measure_focal_scale(&evidence);
      measure_map_depth(*landmarks, visible_, &evidence);
    }
  }
  finish(Stage::kEstimate);
  return evidence;
}

PoseEvidence PoseSolver::solve_and_refine(LandmarkSource* landmarks, std::span<const Match> matches, std::uint64_t seed,
                                          const Rigid3* T_map_explained) {
  const PoseEvidence found = solve(*landmarks, matches, seed, T_map_explained);
  return found.is_found ? refine(landmarks, found.T_map_camera) : found;
}

void PoseSolver::explained_features(const LandmarkSource& landmarks, FeatureSet* all, FeatureSet* distinct) const {
  all->clear();
  distinct->clear();
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    if (inlier_mask_[i] == 0) continue;
    const auto feature = static_cast<std::size_t>(pairs_.feature[i]);
    all->add(feature);
    if (!landmarks.is_repeated(pairs_.landmark[i])) distinct->add(feature);
  }
}

void PoseSolver::append_inliers(std::vector<LandmarkObservation>* inliers) const {
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    if (inlier_mask_[i] != 0)
      inliers->push_back({static_cast<std::uint32_t>(pairs_.landmark[i]), static_cast<std::uint32_t>(pairs_.feature[i])});
  }
}

void PoseSolver::fill_pairs(const LandmarkPositions& landmarks, std::span<const Match> matches, const Rigid3* T_map_explained,
                            std::size_t limit) {
  pairs_.clear();
  for (const Match& match : matches) {
    const auto i = static_cast<std::size_t>(match.feature);
    const Eigen::Vector3f p_map = landmarks.position_m(match.landmark);
    if (T_map_explained != nullptr && is_explained(p_map, i, *T_map_explained)) continue;
    pairs_.add(view_->normalized[i].x(), view_->normalized[i].y(), p_map.x(), p_map.y(), p_map.z(), view_->depth_m[i],
               pair_sigma_px_[view_->features.keypoints[i].level], static_cast<float>(match.distance), match.feature, match.landmark);
  }
  pairs_.sort_by_rank();
  pairs_.truncate(limit);
}

bool PoseSolver::is_explained(const Eigen::Vector3f& p_map, std::size_t feature, const Rigid3& T_map_camera) const {
  const Eigen::Vector3d p_camera = T_map_camera.rotation.conjugate() * (p_map.cast<double>() - T_map_camera.translation);
  if (p_camera.z() <= 0) return false;
  const Eigen::Vector2d error = p_camera.head<2>() / p_camera.z() - view_->normalized[feature].cast<double>();
  return error.norm() * focal_px_ <= kExplainedReach * options_.max_error_px;
}

void PoseSolver::summarize(const PoseRefinementResult& refined, PoseEvidence* evidence) {
  evidence->is_found = true;
  evidence->T_map_camera = refined.T_map_camera;
  evidence->covariance = options_.gathers_evidence ? Matrix6d(refined.covariance * inliers_per_patch()) : refined.covariance;
  evidence->num_inliers = static_cast<std::uint32_t>(refined.num_inliers);
  evidence->num_with_depth = static_cast<std::uint32_t>(refined.num_with_depth);
  evidence->depth_agreement = refined.num_with_depth == 0 ? 1.0 : static_cast<double>(refined.num_depth_inliers) / refined.num_with_depth;
  evidence->rms_px = refined.rms_px;
  evidence->median_px = refined.median_px;
  ImageCells cells(camera_.color.width, camera_.color.height);
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    if (inlier_mask_[i] != 0) cells.add(keypoint_of_pair(i).u, keypoint_of_pair(i).v);
  }
  evidence->spread = cells.share();
}

// One corner is found on several pyramid levels, and its neighbours were mapped with the same depth error: pairs of one
// patch are one observation, not many. Without this the covariance is too small by a factor of about two.
double PoseSolver::inliers_per_patch() {
  std::fill(is_patch_seen_.begin(), is_patch_seen_.end(), std::uint8_t{0});
  const int columns = patch_count(camera_.color.width);
  int num_inliers = 0, num_patches = 0;
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    if (inlier_mask_[i] == 0) continue;
    const Keypoint& keypoint = keypoint_of_pair(i);
    std::uint8_t& is_seen = is_patch_seen_[static_cast<std::size_t>(static_cast<int>(keypoint.v) / kPatchPx * columns +
                                                                    static_cast<int>(keypoint.u) / kPatchPx)];
    num_patches += is_seen == 0 ? 1 : 0;
    is_seen = 1;
    ++num_inliers;
  }
  return num_patches == 0 ? 1.0 : static_cast<double>(num_inliers) / num_patches;
}

void PoseSolver::count_distinct(const LandmarkSource& landmarks, PoseEvidence* evidence) const {
  evidence->num_distinct_visible = evidence->num_distinct_inliers = 0;
  for (const ProjectedLandmark& landmark : visible_) evidence->num_distinct_visible += landmarks.is_repeated(landmark.landmark) ? 0 : 1;
  for (std::size_t i = 0; i < pairs_.size(); ++i)
    evidence->num_distinct_inliers += inlier_mask_[i] != 0 && !landmarks.is_repeated(pairs_.landmark[i]) ? 1 : 0;
}

double PoseSolver::thickness_m() const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d sum_of_squares = Eigen::Matrix3d::Zero();
  int num_inliers = 0;
  // About one of them: landmarks are far from the map's origin, and squares of that cancel badly.
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    if (inlier_mask_[i] == 0) continue;
    const Eigen::Vector3d p_map(pairs_.X[i], pairs_.Y[i], pairs_.Z[i]);
    if (num_inliers++ == 0) origin = p_map;
    sum += p_map - origin;
    sum_of_squares += (p_map - origin) * (p_map - origin).transpose();
  }
  if (num_inliers == 0) return 0;
  const Eigen::Vector3d mean = sum / num_inliers;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
  eigen.computeDirect(sum_of_squares / num_inliers - mean * mean.transpose(), Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, eigen.eigenvalues()[0]));
}

void PoseSolver::measure_focal_scale(PoseEvidence* evidence) {
  PoseRefinementOptions options = refinement_;
  options.estimate_focal_scale = true;
  options.max_error_px *= kFocalReach;
  const PoseRefinementResult fitted = refine_pose(pairs_, evidence->T_map_camera, focal_px_, options, nullptr);
  if (!fitted.is_converged) return;
  evidence->has_focal_scale = true;
  evidence->focal_scale = fitted.focal_scale;
  evidence->focal_scale_sigma = fitted.focal_scale_sigma;
  // How far the pose moves when the focal length is free is what a wrong one can hide.
  const Vector6d shift = pose_error(fitted.T_map_camera, evidence->T_map_camera);
  evidence->covariance += shift * shift.transpose();
}

// Landmarks in front of the measured surface by more than its noise are where the camera sees through: at a wrong pose
// most are. Landmarks behind it are hidden and say nothing: people and moved things do that, too.
void PoseSolver::measure_map_depth(const LandmarkPositions& landmarks, std::span<const ProjectedLandmark> visible,
                                   PoseEvidence* evidence) const {
  const Rigid3 T_camera_map = evidence->T_map_camera.inverse();
  const std::size_t step = std::max<std::size_t>(1, visible.size() / kMapDepthSamples);
  std::uint32_t num_on_surface = 0, num_seen_through = 0;
  for (std::size_t i = 0; i < visible.size(); i += step) {
    const Eigen::Vector3d p_camera = T_camera_map * landmarks.position_m(visible[i].landmark).cast<double>();
    if (p_camera.z() <= 0) continue;
    const Eigen::Vector2d pixel = camera_.color.project(p_camera);
    const double measured = depth_.at(static_cast<float>(pixel.x()), static_cast<float>(pixel.y()));
    if (measured <= 0) continue;
    const double tolerance = kMapDepthTolerance * p_camera.z() + 3.0 * camera_.depth_noise.sigma_m(p_camera.z());
    if (std::abs(measured - p_camera.z()) <= tolerance)
      ++num_on_surface;
    else if (measured > p_camera.z())
      ++num_seen_through;
  }
  evidence->num_map_depth = num_on_surface + num_seen_through;
  if (evidence->num_map_depth > 0) evidence->map_depth_agreement = static_cast<double>(num_on_surface) / evidence->num_map_depth;
}

}  // namespace camloc
