// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/slam/tracker.h"

#include <algorithm>
#include <cmath>

#include "core/base/order_statistics.h"

namespace camloc {
namespace {

constexpr std::size_t kPlacesTried = 5, kKeyframesPerPlace = 6, kNumLocalKeyframes = 16;
constexpr double kMinInlierRatio = 0.3;  // of what was found in the search windows
constexpr double kMaxGapS = 0.5;         // a longer gap between stamps ends the prediction
constexpr double kMinFoundDepthAgreement = 0.7, kMinFoundSpread = 0.12;

double median_depth_m(const FrameFeatures& view) {
  std::vector<float> depths;
  for (const float z : view.depth_m) {
    if (z > 0) depths.push_back(z);
  }
  if (depths.empty()) return 2.0;
  return upper_median(std::move(depths));
}

/// A share of the motion, or more than all of it.
Rigid3 scaled(const Rigid3& motion, double factor) { return {exp_so3(factor * log_so3(motion.rotation)), factor * motion.translation}; }

}  // namespace

Tracker::Tracker(const SlamNumbers& numbers, SlamMap* map, PoseSolver* solver)
    : numbers_(numbers), map_(map), solver_(solver), local_(map->empty_landmark_set()), place_(map->empty_landmark_set()) {}

void Tracker::set_reference(std::uint32_t keyframe) {
  const Rigid3 T_map_camera = map_->T_map_camera(reference_) * T_reference_camera_;
  T_reference_camera_ = map_->T_map_camera(keyframe).inverse() * T_map_camera;
  reference_ = keyframe;
  is_local_set_stale_ = true;
}

void Tracker::accept(std::int64_t stamp_ns, const Rigid3& T_map_camera) {
  const Rigid3 T_map_reference = map_->T_map_camera(reference_);
  const Rigid3 T_reference_new = T_map_reference.inverse() * T_map_camera;
  const double dt_s = seconds(stamp_ns - last_stamp_ns_);
  velocity_.reset();
  if (dt_s > 0 && dt_s <= kMaxGapS) velocity_ = Velocity{T_reference_camera_.inverse() * T_reference_new, dt_s};
  T_reference_camera_ = T_reference_new;
  last_stamp_ns_ = stamp_ns;
}

Rigid3 Tracker::predict(std::int64_t stamp_ns) const {
  const Rigid3 T_map_last = map_->T_map_camera(reference_) * T_reference_camera_;
  const double dt_s = seconds(stamp_ns - last_stamp_ns_);
  if (!velocity_ || dt_s <= 0 || dt_s > kMaxGapS) return T_map_last;
  return T_map_last * scaled(velocity_->T_last_next, std::min(dt_s / velocity_->dt_s, 4.0));
}

void Tracker::update_local_set() {
  if (!is_local_set_stale_) return;
  map_->collect_landmarks(map_->surroundings(reference_, 10, kNumLocalKeyframes), kMaxLocalLandmarks, &local_);
  is_local_set_stale_ = false;
}

bool Tracker::is_plausible(const Registration& found, std::int64_t stamp_ns) const {
  if (!found.is_found || found.num_inliers < numbers_.track_min_inliers || found.inlier_ratio() < kMinInlierRatio) return false;
  const Rigid3 T_map_last = map_->T_map_camera(reference_) * T_reference_camera_;
  const double dt_s = std::max(seconds(stamp_ns - last_stamp_ns_), 0.0);
  return (found.T_map_camera.translation - T_map_last.translation).norm() <= 0.2 + numbers_.track_max_speed_m_s * dt_s;
}

// A wider search is made where the one before has lost much of what the last frame saw: a pattern that repeats (the fins of a
// radiator) may agree with itself one period off, but then the rest of the image does not.
Registration Tracker::track(const FrameFeatures& view, std::uint64_t seed) {
  update_local_set();
  const Rigid3 T_predicted = predict(view.stamp_ns);
  Registration best;
  const auto consider = [&](Registration found) {
    if (is_plausible(found, view.stamp_ns) && found.num_inliers > best.num_inliers) best = std::move(found);
    return best.num_inliers >= numbers_.track_min_kept_share * num_last_inliers_ && best.is_found;
  };
  (void)(consider(register_near(view, T_predicted, numbers_.track_radius_px, seed, &local_, solver_)) ||
         consider(register_near(view, T_predicted, numbers_.track_wide_radius_px, seed, &local_, solver_)) ||
         consider(register_anywhere(view, seed, &local_, solver_)));
  if (!best.is_found) return {};
  num_last_inliers_ = best.num_inliers;
  const std::uint32_t reference = best_reference(best);
  if (reference != reference_) set_reference(reference);
  return best;
}

// The keyframe that sees most of what the frame sees.
std::uint32_t Tracker::best_reference(const Registration& tracked) const {
  std::vector<std::uint32_t> counts(map_->keyframes().size(), 0);
  for (const LandmarkObservation& pair : tracked.inliers) {
    for (const Observation& s : map_->landmark(pair.landmark).observations) ++counts[s.keyframe];
  }
  std::uint32_t best = reference_;
  for (std::uint32_t k = 0; k < counts.size(); ++k) {
    if (counts[k] > counts[best]) best = k;
  }
  return best;
}

Registration Tracker::relocalize(const FrameFeatures& view, const PlaceIndex& places, std::uint64_t seed) {
  const std::uint32_t segment = map_->keyframe(reference_).segment;
  Registration best;
  std::uint32_t best_keyframe = 0;
  std::size_t num_tried = 0;
  for (const RankedKeyframe& place : places.query(view.features.descriptors, 4 * kPlacesTried)) {
    if (map_->keyframe(place.keyframe).segment != segment) continue;
    if (num_tried++ == kPlacesTried) break;
    map_->collect_landmarks(map_->surroundings(place.keyframe, 15, kKeyframesPerPlace), kMaxLocalLandmarks, &place_);
    const Registration found = register_anywhere(view, seed, &place_, solver_);
    if (!is_plausible(found, view.stamp_ns) || found.num_inliers <= best.num_inliers) continue;
    best = found;
    best_keyframe = place.keyframe;
  }
  const bool is_sure = best.is_found && best.num_inliers >= numbers_.found_min_inliers && best.spread >= kMinFoundSpread &&
                       best.depth_agreement >= kMinFoundDepthAgreement;
  if (!is_sure) return {};
  num_last_inliers_ = best.num_inliers;
  set_reference(best_keyframe);
  set_reference(best_reference(best));
  velocity_.reset();
  return best;
}

bool Tracker::wants_keyframe(const FrameFeatures& view, const Registration& tracked) const {
  const SlamKeyframe& reference = map_->keyframe(reference_);
  const Rigid3 T_reference_camera = reference.view.T_map_camera.inverse() * tracked.T_map_camera;
  if (T_reference_camera.translation.norm() > numbers_.keyframe_distance * median_depth_m(view)) return true;
  if (rotation_distance_rad(T_reference_camera.rotation, Eigen::Quaterniond::Identity()) > numbers_.keyframe_angle_rad) return true;
  const double share = static_cast<double>(tracked.num_inliers) / std::max<double>(1, static_cast<double>(view.size()));
  const double share_then = static_cast<double>(reference.num_landmarks) / std::max<double>(1, static_cast<double>(reference.view.size()));
  return tracked.num_inliers < numbers_.keyframe_inliers || share < numbers_.keyframe_share * share_then;
}

}  // namespace camloc
