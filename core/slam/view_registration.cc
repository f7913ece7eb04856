// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/slam/view_registration.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace camloc {
namespace {

constexpr std::size_t kMaxCandidates = 4000;
constexpr std::size_t kMaxRansacPairs = 300;
constexpr int kSpreadColumns = 8, kSpreadRows = 6;

PnpRansacOptions ransac_options(const RegistrationOptions& options) {
  PnpRansacOptions ransac;
  ransac.iterations = 300;
  ransac.max_error_px = 5.0;
  ransac.max_pairs = static_cast<int>(kMaxRansacPairs);
  if (!options.use_depth) ransac.max_relative_depth_error = 0;
  return ransac;
}

}  // namespace

bool is_convincing(const Registration& found, const PlaceLimits& limits) {
  return found.is_found && found.num_inliers() >= limits.min_inliers && found.inlier_ratio() >= limits.min_inlier_ratio &&
         found.depth_agreement >= limits.min_depth_agreement && found.spread >= limits.min_spread;
}

bool is_rival(const Registration& other, const Registration& best, const PlaceLimits& limits) {
  const bool is_elsewhere = (other.T_map_camera.translation - best.T_map_camera.translation).norm() > limits.rival_distance_m ||
                            rotation_distance_rad(other.T_map_camera.rotation, best.T_map_camera.rotation) > limits.rival_angle_rad;
  return is_elsewhere && other.num_inliers() > limits.max_rival_share * best.num_inliers();
}

ViewRegistration::ViewRegistration(const RgbdCamera& camera, float scale_factor, const RegistrationOptions& options)
    : camera_(camera),
      options_(options),
      focal_px_(camera.color.mean_focal_px()),
      grid_(camera.color.width, camera.color.height, options.max_features),
      guided_({.max_distance = options.guided_distance, .max_ratio = options.guided_ratio, .max_matches = options.max_features},
              options.max_features),
      candidate_matcher_({.max_distance = 64, .max_ratio = 0.9}, options.max_features, kMaxCandidates),
      candidates_(kMaxCandidates),
      ransac_(ransac_options(options)),
      pairs_(static_cast<std::size_t>(options.max_features)) {
  for (int level = 0; level < 256; ++level) scale_.push_back(std::pow(scale_factor, static_cast<float>(std::min(level, 31))));
  inlier_mask_.reserve(pairs_.capacity());
}

void ViewRegistration::fill_pairs(const ViewFeatures& view, const LandmarkSet& landmarks, std::span<const Match> matches) {
  pairs_.clear();
  for (const Match& match : matches) {
    const auto f = static_cast<std::size_t>(match.feature), l = static_cast<std::size_t>(match.landmark);
    const Eigen::Vector3f p = landmarks.position_m(l).cast<float>();
    pairs_.add(view.normalized[f].x(), view.normalized[f].y(), p.x(), p.y(), p.z(), view.depth_m[f],
               scale_[view.features.keypoints[f].level], match.distance, match.feature, match.landmark);
  }
}

std::span<const Match> ViewRegistration::matches_around(const ViewFeatures& view, LandmarkSet* landmarks, const Rigid3& T_map_camera,
                                                        float radius_px) {
  grid_.assign(view.features.keypoints);
  const auto visible = landmarks->project(T_map_camera, radius_px, ProjectionLimits{});
  num_visible_ = static_cast<int>(visible.size());
  return guided_.match(view.features, grid_, visible, landmarks->descriptors());
}

// The best-ranked pairs decide where the camera is; everything else is looked up again around that pose.
bool ViewRegistration::solve(std::uint64_t seed, Rigid3* T_map_camera) {
  pairs_.sort_by_rank();
  pairs_.truncate(kMaxRansacPairs);
  const PnpRansacResult found = ransac_.estimate(pairs_, focal_px_, seed);
  if (!found.is_found || found.num_inliers < options_.min_inliers / 2) return false;
  PoseRefinementOptions refinement;
  refinement.depth_noise = camera_.depth_noise;
  refinement.use_depth = options_.use_depth;
  const PoseRefinementResult refined = refine_pose(pairs_, found.T_map_camera, focal_px_, refinement, nullptr);
  *T_map_camera = refined.is_converged ? refined.T_map_camera : found.T_map_camera;
  return true;
}

Registration ViewRegistration::look_again(const ViewFeatures& view, LandmarkSet* landmarks, const Rigid3& T_map_camera) {
  Registration result;
  const auto matches = matches_around(view, landmarks, T_map_camera, options_.fine_radius_px);
  fill_pairs(view, *landmarks, matches);
  result.num_visible = num_visible_;
  result.num_matches = static_cast<int>(matches.size());
  PoseRefinementOptions refinement;
  refinement.depth_noise = camera_.depth_noise;
  refinement.use_depth = options_.use_depth;
  refinement.max_error_px = options_.max_error_px;
  const PoseRefinementResult refined = refine_pose(pairs_, T_map_camera, focal_px_, refinement, &inlier_mask_);
  if (!refined.is_converged || refined.num_inliers < options_.min_inliers) return result;
  result.is_found = true;
  result.T_map_camera = refined.T_map_camera;
  result.covariance = refined.covariance;
  result.median_px = refined.median_px;
  if (refined.num_with_depth > 0) result.depth_agreement = static_cast<double>(refined.num_depth_inliers) / refined.num_with_depth;
  std::array<bool, kSpreadColumns * kSpreadRows> is_hit{};
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    if (inlier_mask_[i] == 0) continue;
    const auto feature = static_cast<std::uint32_t>(pairs_.feature[i]);
    result.inliers.push_back({landmarks->id(static_cast<std::size_t>(pairs_.landmark[i])), feature});
    const Keypoint& keypoint = view.features.keypoints[feature];
    const int column = std::clamp(static_cast<int>(keypoint.u) * kSpreadColumns / camera_.color.width, 0, kSpreadColumns - 1);
    const int row = std::clamp(static_cast<int>(keypoint.v) * kSpreadRows / camera_.color.height, 0, kSpreadRows - 1);
    is_hit[static_cast<std::size_t>(row * kSpreadColumns + column)] = true;
  }
  result.spread = static_cast<double>(std::count(is_hit.begin(), is_hit.end(), true)) / static_cast<double>(is_hit.size());
  return result;
}

Registration ViewRegistration::guided(const ViewFeatures& view, LandmarkSet* landmarks, const Rigid3& T_map_camera_predicted,
                                      float radius_px, std::uint64_t seed) {
  fill_pairs(view, *landmarks, matches_around(view, landmarks, T_map_camera_predicted, radius_px));
  Rigid3 T_map_camera;
  if (!solve(seed, &T_map_camera)) return {};
  return look_again(view, landmarks, T_map_camera);
}

Registration ViewRegistration::unguided(const ViewFeatures& view, LandmarkSet* landmarks, std::uint64_t seed) {
  candidates_.clear();
  for (std::size_t i = 0; i < landmarks->size(); ++i) {
    for (const Descriptor& d : landmarks->descriptors_of(i)) {
      if (!candidates_.add(d, static_cast<std::int32_t>(i), landmarks->angle_rad(i))) break;
    }
  }
  fill_pairs(view, *landmarks, candidate_matcher_.match(view.features, candidates_));
  Rigid3 T_map_camera;
  if (!solve(seed, &T_map_camera)) return {};
  return look_again(view, landmarks, T_map_camera);
}

}  // namespace camloc
