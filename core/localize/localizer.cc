// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/localize/localizer.h"

#include <algorithm>
#include <cmath>

namespace camloc {
namespace {

/// After this long without a verified pose a prediction is no better than a global search.
constexpr std::int64_t kMaxTrackingGapNs = 1'000'000'000;
/// For so long the last verified pose limits where the camera can be. Without that a stretch that looks alike at the other
/// end of the corridor is taken for the real one right after a moment without features.
constexpr std::int64_t kMotionMemoryNs = 5'000'000'000;
/// A fix that contradicts it is believed once it has been found again and again for so long.
constexpr std::int64_t kConfirmationNs = 1'000'000'000;
constexpr std::int64_t kMaxConfirmationGapNs = 500'000'000;
/// For so long a camera that was lost with its eyes open is not believed to be anywhere on thin evidence: after 5.5 s in a bare
/// corridor of the synthetic building nine frames with about 30 inliers were taken for its twin 50 m away; true returns had 112
/// and more.
constexpr std::int64_t kLostMemoryNs = 60'000'000'000;
/// For so long after places that look alike none of them is believed on thin evidence: in the synthetic building a bay was taken for
/// its twin 3.6 m along the corridor right after two frames that could not tell them apart, because the rival was not found again.
constexpr std::int64_t kAmbiguityMemoryNs = 1'000'000'000;
/// A hypothesis with fewer inliers is not even a coarse place.
constexpr std::uint32_t kMinCoarseInliers = 15;

/// What a candidate place may be off: metres and a good part of a turn. It is a hint for people, never a pose.
Matrix6d coarse_uncertainty() {
  Vector6d variance;
  variance << 4.0, 4.0, 4.0, 0.5, 0.5, 0.5;
  return variance.asDiagonal();
}

/// Levels of image and map must be the same ones: the map rules.
LocalizerOptions with_pyramid_of(const MapView& map, LocalizerOptions options) {
  options.orb.scale_factor = map.info().orb_scale_factor;
  options.orb.num_levels = static_cast<int>(map.info().orb_num_levels);
  return options;
}

PoseEstimatorOptions estimator_options(const LocalizerOptions& options) {
  PoseEstimatorOptions estimator;
  estimator.refinement.use_depth = options.use_depth;
  return estimator;
}

}  // namespace

Localizer::Localizer(const MapView& map, const RgbdCamera& camera, const LocalizerOptions& options)
    : map_(&map),
      options_(with_pyramid_of(map, options)),
      timer_(options_.now_ns),
      observations_(camera, options_.orb, options_.use_depth),
      estimator_(map, camera, options_.orb, estimator_options(options_), &timer_),
      global_search_(map, options_.orb, GlobalSearchOptions{}, &timer_),
      motion_(MotionModelOptions{}),
      unconfirmed_(MotionModelOptions{}),
      calibration_(CalibrationMonitorOptions{}),
      focal_px_(camera.color.mean_focal_px()) {}

const Localization& Localizer::process(const Frame& frame) {
  begin(frame);
  if (map_->is_damaged()) return decline(frame, {.reason = Reason::kMapDamaged});
  if (!observations_.observe(frame)) return decline(frame, {.reason = Reason::kNoImage});
  result_.num_features = static_cast<std::uint32_t>(observations_.size());
  timer_.finish(Stage::kExtract);
  if (observations_.size() < verification_.min_features) return decline(frame, {.reason = Reason::kFewFeatures});

  Candidate candidate = track(frame);
  if (candidate.reason != Reason::kNone) candidate = search_globally(frame);
  watch_calibration(candidate.hypothesis);
  timer_.finish(Stage::kVerify);
  return candidate.reason == Reason::kNone ? accept(frame, candidate) : decline(frame, candidate);
}

// Matches with another place ask for any focal length: only what could be a pose has a say.
void Localizer::watch_calibration(const PoseHypothesis& hypothesis) {
  if (!hypothesis.has_focal_scale || hypothesis.num_inliers < verification_.min_inliers) return;
  calibration_.add(hypothesis.focal_scale, hypothesis.focal_scale_sigma);
}

void Localizer::reset() {
  motion_.reset();
  unconfirmed_.reset();
  ambiguous_ns_.reset();
}

void Localizer::begin(const Frame& frame) {
  timer_.start();
  const std::uint32_t reset_counter = result_.reset_counter;
  result_ = Localization{};
  result_.reset_counter = reset_counter;
  result_.sequence = frame.sequence;
  result_.stamp_ns = frame.stamp_ns;
  const bool is_time_reversed = motion_.has_fix() && frame.stamp_ns <= motion_.last_stamp_ns();
  if (!options_.use_tracking || is_time_reversed) reset();
}

Localizer::Candidate Localizer::track(const Frame& frame) {
  Candidate candidate{.is_tracked = true};
  if (!is_recent(frame.stamp_ns, kMaxTrackingGapNs)) return candidate;
  const Rigid3 T_map_predicted = motion_.predict(frame.stamp_ns);
  const Matrix6d uncertainty = motion_.predict_covariance(frame.stamp_ns);
  const double turn_sigma_rad = std::sqrt(uncertainty.diagonal().tail<3>().maxCoeff());
  const auto radius_px = static_cast<float>(std::clamp(10.0 + 2.0 * focal_px_ * turn_sigma_rad, 15.0, 0.15 * focal_px_));

  const auto matches = estimator_.match_around(observations_, T_map_predicted, radius_px);
  candidate.hypothesis = estimator_.from_matches(observations_, matches, frame.sequence);
  if (candidate.hypothesis.is_found) candidate.hypothesis = estimator_.look_again(observations_, candidate.hypothesis);
  candidate.reason = verify(candidate.hypothesis, candidate.margin, candidate.is_tracked, verification_);
  if (candidate.reason == Reason::kNone && !fits_motion(frame, candidate.hypothesis)) candidate.reason = Reason::kImplausibleMotion;
  return candidate;
}

Localizer::Candidate Localizer::search_globally(const Frame& frame) {
  const GlobalSearchResult found = global_search_.search(observations_, estimator_, frame.sequence);
  Candidate candidate{.hypothesis = found.best, .margin = found.margin, .is_tracked = false};
  candidate.reason = found.has_candidates ? verify(found.best, found.margin, candidate.is_tracked, verification_) : Reason::kNoCandidates;
  if (candidate.reason == Reason::kNone && !fits_motion(frame, found.best) && !is_confirmed(frame, found.best))
    candidate.reason = Reason::kImplausibleMotion;
  if (candidate.reason == Reason::kAmbiguous) ambiguous_ns_ = frame.stamp_ns;
  if (candidate.reason == Reason::kNone && was_ambiguous(frame, found.best)) candidate.reason = Reason::kAmbiguous;
  return candidate;
}

// A handful of inliers on a repeated texture can be one tile off, and depth does not tell: such a pose must be where the
// motion so far expects it. Strong evidence may contradict the prediction within what a camera can do. When the motion is
// forgotten only strong evidence counts, until the loss is so long ago that the camera may have been carried anywhere.
bool Localizer::fits_motion(const Frame& frame, const PoseHypothesis& hypothesis) const {
  if (!is_recent(frame.stamp_ns, kLostMemoryNs)) return true;
  const bool is_thin = hypothesis.num_inliers < verification_.strong_inliers;
  if (is_thin && !is_recent(frame.stamp_ns, kMotionMemoryNs)) return false;
  if (is_thin) return motion_.is_expected(frame.stamp_ns, hypothesis.T_map_camera, hypothesis.covariance);
  return motion_.is_plausible(frame.stamp_ns, hypothesis.T_map_camera);
}

bool Localizer::is_confirmed(const Frame& frame, const PoseHypothesis& hypothesis) {
  if (hypothesis.num_inliers < verification_.strong_inliers) return false;
  const bool is_continued = unconfirmed_.has_fix() && frame.stamp_ns - unconfirmed_.last_stamp_ns() <= kMaxConfirmationGapNs &&
                            unconfirmed_.is_plausible(frame.stamp_ns, hypothesis.T_map_camera);
  if (!is_continued) unconfirmed_since_ns_ = frame.stamp_ns;
  unconfirmed_.add_fix(frame.stamp_ns, hypothesis.T_map_camera, Matrix6d::Zero(), false);
  return frame.stamp_ns - unconfirmed_since_ns_ >= kConfirmationNs;
}

// Once the motion says little, places that looked alike must stay apart for a while before one of them is believed.
bool Localizer::was_ambiguous(const Frame& frame, const PoseHypothesis& hypothesis) const {
  if (hypothesis.num_inliers >= verification_.strong_inliers || is_recent(frame.stamp_ns, kMaxTrackingGapNs)) return false;
  return ambiguous_ns_ && frame.stamp_ns - *ambiguous_ns_ <= kAmbiguityMemoryNs;
}

const Localization& Localizer::accept(const Frame& frame, const Candidate& candidate) {
  const PoseHypothesis& hypothesis = candidate.hypothesis;
  result_.state = State::kLocalized;
  result_.reason = Reason::kNone;
  result_.has_pose = true;
  result_.T_map_camera = hypothesis.T_map_camera;
  result_.covariance = with_map_uncertainty(hypothesis.covariance);
  result_.quality = quality_of(hypothesis, candidate.margin);
  if (!candidate.is_tracked) {
    ++result_.reset_counter;
    if (motion_.has_fix()) result_.jump_m = (hypothesis.T_map_camera.translation - motion_.predict(frame.stamp_ns).translation).norm();
  }
  motion_.add_fix(frame.stamp_ns, hypothesis.T_map_camera, hypothesis.covariance, candidate.is_tracked);
  unconfirmed_.reset();
  return finish(candidate);
}

const Localization& Localizer::decline(const Frame& frame, const Candidate& candidate) {
  result_.reason = candidate.reason;
  result_.state = State::kLost;
  if (is_recent(frame.stamp_ns, options_.max_coast_ns)) {
    result_.state = State::kCoasting;
    result_.has_pose = true;
    result_.T_map_camera = motion_.predict(frame.stamp_ns);
    result_.covariance = with_map_uncertainty(motion_.predict_covariance(frame.stamp_ns));
    result_.quality = 0;
  } else if (candidate.hypothesis.is_found && candidate.hypothesis.num_inliers >= kMinCoarseInliers) {
    result_.state = State::kCoarse;
    result_.has_pose = true;
    result_.T_map_camera = candidate.hypothesis.T_map_camera;
    result_.covariance = with_map_uncertainty(candidate.hypothesis.covariance) + coarse_uncertainty();
    result_.quality = 0;
  }
  return finish(candidate);
}

const Localization& Localizer::finish(const Candidate& candidate) {
  const PoseHypothesis& hypothesis = candidate.hypothesis;
  result_.is_tracked = candidate.is_tracked;
  result_.num_visible = hypothesis.num_visible;
  result_.num_matches = hypothesis.num_matches;
  result_.num_inliers = hypothesis.num_inliers;
  result_.inlier_ratio = hypothesis.inlier_ratio();
  result_.spread = hypothesis.spread;
  result_.margin = candidate.margin;
  result_.focal_scale = hypothesis.focal_scale;
  result_.depth_agreement = hypothesis.depth_agreement;
  result_.map_depth_agreement = hypothesis.map_depth_agreement;
  timer_.finish(Stage::kVerify);
  result_.stage_ns = timer_.stop();
  return result_;
}

Matrix6d Localizer::with_map_uncertainty(const Matrix6d& covariance) const {
  Matrix6d total = covariance;
  total.diagonal().head<3>().array() += map_->info().pose_sigma_m * map_->info().pose_sigma_m;
  total.diagonal().tail<3>().array() += map_->info().pose_sigma_rad * map_->info().pose_sigma_rad;
  return total;
}

bool Localizer::is_recent(std::int64_t stamp_ns, std::int64_t max_age_ns) const {
  return options_.use_tracking && motion_.has_fix() && stamp_ns - motion_.last_stamp_ns() <= max_age_ns;
}

}  // namespace camloc
