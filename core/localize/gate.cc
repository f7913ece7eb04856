// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/localize/gate.h"

#include <algorithm>

namespace camloc {

Gate::Gate(const LocalizerNumbers& numbers, bool has_memory)
    : numbers_(numbers), has_memory_(has_memory), motion_(numbers), belief_(numbers) {}

void Gate::reset() {
  motion_.reset();
  belief_.reset();
  num_last_inliers_ = 0;
}

void Gate::begin(std::int64_t stamp_ns) {
  const bool is_time_reversed = motion_.has_fix() && stamp_ns <= motion_.last_stamp_ns();
  if (!has_memory_ || is_time_reversed) reset();
}

bool Gate::is_recent(std::int64_t stamp_ns, std::int64_t max_age_ns) const {
  return has_memory_ && motion_.has_fix() && stamp_ns - motion_.last_stamp_ns() <= max_age_ns;
}

std::optional<Gate::Prediction> Gate::predict(std::int64_t stamp_ns, std::int64_t max_age_ns) const {
  if (!is_recent(stamp_ns, max_age_ns)) return std::nullopt;
  return Prediction{motion_.predict(stamp_ns), motion_.predict_covariance(stamp_ns)};
}

bool Gate::withstands(const Candidate& candidate, const Rigid3& T_map_rival, double lead) {
  if (belief_.challenge(candidate.evidence.T_map_camera, T_map_rival, lead) > 0) return true;
  reset();
  return false;
}

Reason Gate::judge(std::int64_t stamp_ns, const Candidate& candidate) {
  if (candidate.is_continuation) {
    return candidate.reason == Reason::kNone && !fits_motion(stamp_ns, candidate) ? Reason::kImplausibleMotion : candidate.reason;
  }
  if (candidate.reason == Reason::kAmbiguous) belief_.note_contest(stamp_ns);
  if (candidate.reason != Reason::kNone || candidate.overrides_motion) return candidate.reason;
  if (!fits_motion(stamp_ns, candidate) && !is_confirmed(stamp_ns, candidate)) return Reason::kImplausibleMotion;
  return is_contested(stamp_ns, candidate) ? Reason::kAmbiguous : Reason::kNone;
}

// A handful of inliers on a repeated texture can be one tile off, and depth does not tell: such a pose must be where the
// motion so far expects it. Strong evidence may contradict the prediction within what a camera can do. When the motion is
// forgotten only strong evidence counts, until the loss is so long ago that the camera may have been carried anywhere.
bool Gate::fits_motion(std::int64_t stamp_ns, const Candidate& candidate) const {
  if (!is_recent(stamp_ns, ns(numbers_.lost_memory_s))) return true;
  if (is_thin(candidate) && !is_recent(stamp_ns, ns(numbers_.motion_memory_s))) return false;
  if (!motion_.is_plausible(stamp_ns, candidate.evidence.T_map_camera)) return false;
  return !is_thin(candidate) || motion_.is_expected(stamp_ns, candidate.evidence.T_map_camera, candidate.evidence.covariance);
}

// What contradicts the motion must be found again and again; the thinner it is, the longer.
bool Gate::is_confirmed(std::int64_t stamp_ns, const Candidate& candidate) {
  constexpr double kRounding = 1e-9;
  const double weight = std::min(1.0, static_cast<double>(candidate.evidence.num_inliers) / numbers_.strong_inliers);
  return belief_.claim(stamp_ns, candidate.evidence.T_map_camera, weight) >= (1 - kRounding) * belief_.limit();
}

// Once the motion says little, places that looked alike must stay apart for a while before one of them is believed.
bool Gate::is_contested(std::int64_t stamp_ns, const Candidate& candidate) const {
  if (!is_thin(candidate) || is_recent(stamp_ns, ns(numbers_.max_tracking_gap_s))) return false;
  return belief_.is_contested(stamp_ns);
}

bool Gate::is_doubtful(const Candidate& candidate) const {
  return candidate.is_continuation && is_thin(candidate) && candidate.evidence.num_inliers < numbers_.min_kept_share * num_last_inliers_;
}

double Gate::accept(std::int64_t stamp_ns, const Candidate& candidate) {
  const PoseEvidence& pose = candidate.evidence;
  const bool is_jump = !candidate.is_continuation && motion_.has_fix();
  const double jump_m = is_jump ? (pose.T_map_camera.translation - motion_.predict(stamp_ns).translation).norm() : 0;
  motion_.add_fix(stamp_ns, pose.T_map_camera, pose.covariance, candidate.is_continuation);
  belief_.forget_claims();
  num_last_inliers_ = pose.num_inliers;
  return jump_m;
}

}  // namespace camloc
