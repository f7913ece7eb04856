// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/localize/pose_estimator.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace camloc {
namespace {

constexpr int kSpreadColumns = 8;
constexpr int kSpreadRows = 6;
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

PnpRansacOptions sized(PnpRansacOptions options, int max_pairs) {
  options.max_pairs = max_pairs;
  return options;
}

}  // namespace

PoseEstimator::PoseEstimator(const MapView& map, const RgbdCamera& camera, const OrbOptions& orb, const PoseEstimatorOptions& options,
                             StageTimer* timer)
    : map_(&map),
      color_(camera.color),
      focal_px_(camera.color.mean_focal_px()),
      options_(options),
      local_(map, camera.color, options.local),
      guided_(options.guided, orb.num_features),
      ransac_(sized(options.ransac, options.max_ransac_pairs)),
      pairs_(static_cast<std::size_t>(orb.num_features)),
      inlier_mask_(static_cast<std::size_t>(orb.num_features)),
      is_patch_seen_(static_cast<std::size_t>(patch_count(camera.color.width) * patch_count(camera.color.height))),
      timer_(timer) {
  options_.refinement.depth_noise = camera.depth_noise;
}

PoseHypothesis PoseEstimator::from_matches(const FrameObservations& frame, std::span<const Match> matches, std::uint64_t seed,
                                           const Rigid3* T_map_explained) {
  PoseHypothesis hypothesis;
  hypothesis.num_matches = static_cast<std::uint32_t>(matches.size());
  fill_pairs(frame, matches, T_map_explained, static_cast<std::size_t>(options_.max_ransac_pairs));
  const PnpRansacResult found = ransac_.estimate(pairs_, focal_px_, seed);
  if (found.is_found) {
    const PoseRefinementResult refined = refine_pose(pairs_, found.T_map_camera, focal_px_, options_.refinement, &inlier_mask_);
    if (refined.is_converged) summarize(frame, refined, &hypothesis);
  }
  timer_->finish(Stage::kEstimate);
  return hypothesis;
}

std::span<const Match> PoseEstimator::match_around(const FrameObservations& frame, const Rigid3& T_map_camera, float radius_px) {
  visible_ = local_.project(T_map_camera, radius_px);
  const auto matches = guided_.match(frame.features(), frame.grid(), visible_, map_->descriptors());
  timer_->finish(Stage::kMatch);
  return matches;
}

PoseHypothesis PoseEstimator::look_again(const FrameObservations& frame, const PoseHypothesis& hypothesis) {
  PoseHypothesis again;
  const auto matches = match_around(frame, hypothesis.T_map_camera, options_.guided_radius_px);
  again.num_matches = static_cast<std::uint32_t>(matches.size());
  again.num_visible = static_cast<std::uint32_t>(visible_.size());
  fill_pairs(frame, matches, nullptr, pairs_.capacity());
  if (pairs_.size() < kMinPairs) return again;
  const PoseRefinementResult refined = refine_pose(pairs_, hypothesis.T_map_camera, focal_px_, options_.refinement, &inlier_mask_);
  if (refined.is_converged) {
    summarize(frame, refined, &again);
    measure_focal_scale(&again);
    measure_map_depth(frame, visible_, &again);
  }
  timer_->finish(Stage::kEstimate);
  return again;
}

void PoseEstimator::fill_pairs(const FrameObservations& frame, std::span<const Match> matches, const Rigid3* T_map_explained,
                               std::size_t limit) {
  pairs_.clear();
  for (const Match& match : matches) {
    if (T_map_explained != nullptr && is_explained(frame, match, *T_map_explained)) continue;
    const auto i = static_cast<std::size_t>(match.feature);
    const Eigen::Vector3f p_map = map_->position_m(static_cast<std::uint32_t>(match.landmark));
    pairs_.add(frame.x(i), frame.y(i), p_map.x(), p_map.y(), p_map.z(), frame.depth_m(i), frame.sigma_px(i),
               static_cast<float>(match.distance), match.feature, match.landmark);
  }
  pairs_.sort_by_rank();
  pairs_.truncate(limit);
}

bool PoseEstimator::is_explained(const FrameObservations& frame, const Match& match, const Rigid3& T_map_camera) const {
  const Eigen::Vector3d p_map = map_->position_m(static_cast<std::uint32_t>(match.landmark)).cast<double>();
  const Eigen::Vector3d p_camera = T_map_camera.rotation.conjugate() * (p_map - T_map_camera.translation);
  if (p_camera.z() <= 0) return false;
  const auto i = static_cast<std::size_t>(match.feature);
  const double error = std::hypot(p_camera.x() / p_camera.z() - frame.x(i), p_camera.y() / p_camera.z() - frame.y(i));
  return error * focal_px_ <= kExplainedReach * options_.refinement.max_error_px;
}

void PoseEstimator::summarize(const FrameObservations& frame, const PoseRefinementResult& refined, PoseHypothesis* hypothesis) {
  hypothesis->is_found = true;
  hypothesis->T_map_camera = refined.T_map_camera;
  hypothesis->covariance = refined.covariance * inliers_per_patch(frame);
  hypothesis->num_inliers = static_cast<std::uint32_t>(refined.num_inliers);
  hypothesis->num_with_depth = static_cast<std::uint32_t>(refined.num_with_depth);
  hypothesis->depth_agreement = refined.num_with_depth == 0 ? 1.0 : static_cast<double>(refined.num_depth_inliers) / refined.num_with_depth;
  hypothesis->rms_px = refined.rms_px;

  std::uint64_t occupied = 0;
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    if (inlier_mask_[i] == 0) continue;
    const Keypoint& keypoint = frame.features().keypoints[static_cast<std::size_t>(pairs_.feature[i])];
    const int column = std::clamp(static_cast<int>(keypoint.u) * kSpreadColumns / color_.width, 0, kSpreadColumns - 1);
    const int row = std::clamp(static_cast<int>(keypoint.v) * kSpreadRows / color_.height, 0, kSpreadRows - 1);
    occupied |= std::uint64_t{1} << (row * kSpreadColumns + column);
  }
  hypothesis->spread = static_cast<double>(std::popcount(occupied)) / (kSpreadColumns * kSpreadRows);
}

// One corner is found on several pyramid levels, and its neighbours were mapped with the same depth error: pairs of one
// patch are one observation, not many. Without this the covariance is too small by a factor of about two.
double PoseEstimator::inliers_per_patch(const FrameObservations& frame) {
  std::fill(is_patch_seen_.begin(), is_patch_seen_.end(), std::uint8_t{0});
  const int columns = patch_count(color_.width);
  int num_inliers = 0, num_patches = 0;
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    if (inlier_mask_[i] == 0) continue;
    const Keypoint& keypoint = frame.features().keypoints[static_cast<std::size_t>(pairs_.feature[i])];
    const int column = static_cast<int>(keypoint.u) / kPatchPx, row = static_cast<int>(keypoint.v) / kPatchPx;
    std::uint8_t& is_seen = is_patch_seen_[static_cast<std::size_t>(row * columns + column)];
    num_patches += is_seen == 0 ? 1 : 0;
    is_seen = 1;
    ++num_inliers;
  }
  return num_patches == 0 ? 1.0 : static_cast<double>(num_inliers) / num_patches;
}

void PoseEstimator::measure_focal_scale(PoseHypothesis* hypothesis) {
  PoseRefinementOptions options = options_.refinement;
  options.estimate_focal_scale = true;
  options.max_error_px *= kFocalReach;
  const PoseRefinementResult fitted = refine_pose(pairs_, hypothesis->T_map_camera, focal_px_, options, nullptr);
  if (!fitted.is_converged) return;
  hypothesis->has_focal_scale = true;
  hypothesis->focal_scale = fitted.focal_scale;
  hypothesis->focal_scale_sigma = fitted.focal_scale_sigma;
  // How far the pose moves when the focal length is free is what a wrong one can hide.
  const Vector6d shift = pose_error(fitted.T_map_camera, hypothesis->T_map_camera);
  hypothesis->covariance += shift * shift.transpose();
}

// Landmarks in front of the measured surface by more than its noise are where the camera sees through: at a wrong pose
// most are. Landmarks behind it are hidden and say nothing: people and moved things do that, too.
void PoseEstimator::measure_map_depth(const FrameObservations& frame, std::span<const ProjectedLandmark> visible,
                                      PoseHypothesis* hypothesis) const {
  const Rigid3 T_camera_map = hypothesis->T_map_camera.inverse();
  const std::size_t step = std::max<std::size_t>(1, visible.size() / kMapDepthSamples);
  std::uint32_t num_on_surface = 0, num_seen_through = 0;
  for (std::size_t i = 0; i < visible.size(); i += step) {
    const Eigen::Vector3d p_camera = T_camera_map * map_->position_m(static_cast<std::uint32_t>(visible[i].landmark)).cast<double>();
    if (p_camera.z() <= 0) continue;
    const Eigen::Vector2d pixel = color_.project(p_camera);
    const double measured = frame.depth_at(static_cast<float>(pixel.x()), static_cast<float>(pixel.y()));
    if (measured <= 0) continue;
    const double tolerance = kMapDepthTolerance * p_camera.z() + 3.0 * options_.refinement.depth_noise.sigma_m(p_camera.z());
    if (std::abs(measured - p_camera.z()) <= tolerance)
      ++num_on_surface;
    else if (measured > p_camera.z())
      ++num_seen_through;
  }
  hypothesis->num_map_depth = num_on_surface + num_seen_through;
  if (hypothesis->num_map_depth > 0) hypothesis->map_depth_agreement = static_cast<double>(num_on_surface) / hypothesis->num_map_depth;
}

}  // namespace camloc
