// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The whole job is process(): observe the frame; for each proposer, cheapest first, examine what it proposes (solve each place, take
// the best pose, solve the places that the map calls its look-alikes, verify it) and ask the gate whether it is to be believed, and
// motion parallax whether it is no picture, until one is without doubt; then report. Below it are those steps, in that order.
#include "core/localize/localizer.h"

#include <algorithm>
#include <cmath>

#include "core/localize/verification.h"
#include "core/registration/rivals.h"

namespace camloc {
namespace {

/// Descriptors of one place that are compared with the image.
constexpr int kMaxCandidates = 8000;
/// Sampling is seeded by the frame and the place: seeds of neighbouring frames do not meet.
constexpr std::uint64_t kSeedsPerFrame = 8;
/// A tracked place is held against a look-alike once in so many frames: places change slowly.
constexpr std::size_t kFramesPerRival = 3;
/// Between the samplings of two values of LocalizerNumbers::seed: more frames than there will ever be.
constexpr std::uint64_t kSeedStride = 0x9E3779B97F4A7C15ULL;
/// A rival that was found this close to where the map names one was asked already.
constexpr RivalDistance kSamePlace{.position_m = 0.5, .rotation_rad = 0.35};

/// A pose before none, more evidence before less; of what is no pose the last word.
bool is_better(const Candidate& candidate, const Candidate& best) {
  if (best.reason != Reason::kNone) return true;
  return candidate.reason == Reason::kNone && candidate.evidence.num_inliers > best.evidence.num_inliers;
}

/// What a candidate place may be off: metres and a good part of a turn. It is a hint for people, never a pose.
Matrix6d coarse_uncertainty() {
  Vector6d variance;
  variance << 4.0, 4.0, 4.0, 0.5, 0.5, 0.5;
  return variance.asDiagonal();
}

/// Cubes of 4 m that a small room has.
constexpr double kCubesOfRoom = 4;

/// Levels of image and map must be the same ones: the map rules. A pose that is the best of many places is right by more inliers only.
LocalizerOptions fitted_to(const MapView& map, LocalizerOptions options) {
  const double doublings = std::max(0.0, std::log2(static_cast<double>(map.cubes().size()) / kCubesOfRoom));
  const auto more = static_cast<std::uint32_t>(options.numbers.inliers_per_doubling * doublings);
  options.numbers.min_inliers += more;
  options.numbers.min_inliers_no_depth += more;
  options.orb.scale_factor = map.info().orb_scale_factor;
  options.orb.num_levels = static_cast<int>(map.info().orb_num_levels);
  return options;
}

MapLandmarksOptions landmark_options(const LocalizerNumbers& numbers) {
  MapLandmarksOptions options;
  options.max_landmarks = numbers.max_landmarks;
  options.limits.max_range_m = numbers.max_range_m;
  options.limits.view_angle_margin_rad = numbers.view_angle_margin_rad;
  return options;
}

PoseSolverOptions solver_options(const LocalizerOptions& options, const MapInfo& map) {
  PoseSolverOptions solver;
  solver.shared_errors = {map.pose_sigma_m, map.pose_sigma_rad};
  solver.max_features = options.orb.num_features;
  solver.max_candidates = kMaxCandidates;
  solver.ransac_iterations = options.numbers.ransac_iterations;
  solver.max_ransac_pairs = options.numbers.max_ransac_pairs;
  solver.max_ransac_error_px = solver.max_error_px = options.numbers.max_error_px;
  solver.guided_radius_px = options.numbers.guided_radius_px;
  solver.use_depth = options.use_depth;
  return solver;
}

}  // namespace

Localizer::Localizer(const MapView& map, const RgbdCamera& camera, const LocalizerOptions& options,
                     std::span<const ProposerEntry> proposers)
    : map_(&map),
      camera_(camera),
      options_(fitted_to(map, options)),
      timer_(options_.now_ns),
      extractor_(camera, options_.orb, options_.use_depth),
      rivals_(map, options_.numbers),
      landmarks_(map, camera.color, landmark_options(options_.numbers), &rivals_.look_alikes()),
      levels_(options_.orb.scale_factor, options_.orb.num_levels),
      solver_(camera, levels_, solver_options(options_, map.info()), &timer_),
      list_(map.info().max_keyframe_landmarks),
      visit_of_landmark_(map.landmarks().size(), 0),
      gate_(options_.numbers, options_.use_tracking),
      parallax_({.max_sightings = static_cast<std::size_t>(options_.orb.num_features),
                 .min_shared = options_.numbers.min_parallax_landmarks,
                 .min_evidence = options_.numbers.min_parallax_evidence}),
      calibration_(options_.numbers) {
  view_.reserve(static_cast<std::size_t>(options_.orb.num_features));
  inliers_.reserve(view_.features.keypoints.capacity());
  sightings_.reserve(inliers_.capacity());
  // Twice: a proposer may join the one before.
  found_.reserve(2 * (2 * static_cast<std::size_t>(std::max(1, options_.numbers.max_places)) + 2 * rivals_.capacity()));
  for (const ProposerEntry& entry : proposers)
    proposers_.push_back({entry.name, entry.make({map_, &camera_, &options_.numbers, options_.orb.num_features})});
}

const Localization& Localizer::process(const Frame& frame) {
  begin(frame);
  if (const Reason unusable = observe(frame); unusable != Reason::kNone) return decline(frame, {.reason = unusable});

  Candidate best;
  const NamedProposer* proposed_by = nullptr;
  for (const NamedProposer& asked : proposers_) {
    const auto proposals = asked.proposer->propose({frame.stamp_ns, &view_, &gate_});
    timer_.finish(Stage::kCandidates);
    const bool joins_earlier = asked.proposer->joins_earlier();
    Candidate candidate = examine(frame, proposals, joins_earlier);
    if (joins_earlier && candidate.reason == Reason::kNoCandidates) continue;
    candidate.reason = gate_.judge(frame.stamp_ns, candidate);
    if (candidate.reason == Reason::kNone && !is_shown_no_picture(frame.stamp_ns, candidate)) candidate.reason = Reason::kNoParallax;
    if (is_better(candidate, best)) {
      best = candidate;
      proposed_by = &asked;
    }
    if (best.reason == Reason::kNone && !gate_.is_doubtful(best)) break;
  }
  watch_calibration(best.evidence);
  if (best.reason != Reason::kNone) return decline(frame, best);
  proposed_by->proposer->on_accepted();
  return accept(frame, best, proposed_by->name);
}

void Localizer::hint(const PoseHint& hint) {
  for (const NamedProposer& asked : proposers_) asked.proposer->on_hint(hint);
}

void Localizer::coarse_hint(const CoarseHint& hint) {
  if (!hint.is_valid()) return;
  coarse_ = hint;
  for (const NamedProposer& asked : proposers_) asked.proposer->on_coarse(hint);
}

void Localizer::reset() {
  gate_.reset();
  parallax_.reset();
  rival_turn_ = 0;
}

void Localizer::begin(const Frame& frame) {
  timer_.start();
  const std::uint32_t reset_counter = result_.reset_counter;
  result_ = Localization{};
  result_.reset_counter = reset_counter;
  result_.sequence = frame.sequence;
  result_.stamp_ns = frame.stamp_ns;
  gate_.begin(frame.stamp_ns);
}

Reason Localizer::observe(const Frame& frame) {
  if (map_->is_damaged()) return Reason::kMapDamaged;
  if (!extractor_.has_image(frame)) return Reason::kNoImage;
  extractor_.extract(frame, &view_);
  solver_.begin(view_, extractor_.depth_of(frame));
  result_.num_features = static_cast<std::uint32_t>(view_.size());
  timer_.finish(Stage::kExtract);
  return view_.size() < options_.numbers.min_features ? Reason::kFewFeatures : Reason::kNone;
}

// The pose with the most inliers; what else was found says how far it stands out. Before a place is believed, those that the map calls
// its look-alikes are asked, too.
Candidate Localizer::examine(const Frame& frame, std::span<const Proposal> proposals, bool joins_earlier) {
  if (!joins_earlier) found_.clear();
  if (proposals.empty()) return {.reason = Reason::kNoCandidates};
  proposals = proposals.first(std::min(proposals.size(), static_cast<std::size_t>(std::max(1, options_.numbers.max_places))));
  const std::uint64_t seed = frame.sequence * kSeedsPerFrame + options_.numbers.seed * kSeedStride;
  const std::size_t num_earlier = found_.size();
  for (std::size_t i = 0; i < proposals.size(); ++i) solve(proposals[i], seed + i);
  if (best_of_found() < num_earlier) return {.reason = Reason::kNoCandidates};
  Candidate best{.is_continuation = proposals.front().is_continuation, .overrides_motion = proposals.front().overrides_motion};
  // A rival that explains more has rivals of its own.
  for (int round = 0; round < 2 && !best.is_continuation; ++round) {
    const std::size_t before = best_of_found();
    ask_rivals(&found_[before], seed);
    if (best_of_found() == before) break;
  }
  const Hypothesis& found = found_[best_of_found()];
  best.evidence = found;
  best.standing = {margin_of(found_, found, apart()), lead_of(found_, found, apart())};
  best.reason = verify(best.evidence, best.standing, best.is_continuation, options_.numbers);
  if (best.is_continuation && best.reason == Reason::kNone && !withstands_a_rival(&best, seed)) best.reason = Reason::kAmbiguous;
  timer_.finish(Stage::kVerify);
  return best;
}

std::size_t Localizer::best_of_found() const {
  const auto best = std::max_element(found_.begin(), found_.end(), [](const Hypothesis& a, const Hypothesis& b) {
    return a.is_found != b.is_found ? b.is_found : a.num_inliers < b.num_inliers;
  });
  return static_cast<std::size_t>(best - found_.begin());
}

void Localizer::ask_rivals(Hypothesis* best, std::uint64_t seed) {
  if (!best->is_found || best->num_inliers < options_.numbers.min_inliers) return;
  for (const Rigid3& T_map_camera : rivals_.of(best->T_map_camera)) {
    best->is_look_alike = true;
    const auto asked = std::find_if(found_.begin(), found_.end(), [&](const Hypothesis& found) {
      return found.is_found && !are_rivals(found.T_map_camera, T_map_camera, kSamePlace);
    });
    if (asked != found_.end()) asked->is_look_alike = true;
    if (asked != found_.end() || found_.size() == found_.capacity()) continue;
    const auto matches = solver_.search_by_projection(&landmarks_, T_map_camera, static_cast<float>(options_.numbers.rival_radius_px));
    const std::size_t before = found_.size();
    keep(solver_.solve_and_refine(&landmarks_, matches, seed));
    if (found_.size() > before) found_.back().is_look_alike = true;
  }
}

// Depth shows it at once; without depth motion has to, before the first pose and after each time that the camera was lost.
bool Localizer::is_shown_no_picture(std::int64_t stamp_ns, const Candidate& candidate) {
  const bool has_depth = candidate.evidence.num_map_depth >= options_.numbers.min_map_depth_samples;
  if (has_depth || candidate.is_continuation || gate_.predict(stamp_ns)) return true;
  if (!options_.use_tracking) return false;
  // Once more, for its inliers: other poses were solved after it.
  const PoseEvidence again = solver_.refine(&landmarks_, candidate.evidence.T_map_camera);
  if (!again.is_found) return false;
  inliers_.clear();
  sightings_.clear();
  solver_.append_inliers(&inliers_);
  const Rigid3 T_camera_map = again.T_map_camera.inverse();
  const double pixel = 1 / camera_.color.mean_focal_px();
  for (const LandmarkObservation& inlier : inliers_) {
    const Eigen::Vector3d p = T_camera_map * landmarks_.position_m(static_cast<std::int32_t>(inlier.landmark)).cast<double>();
    sightings_.push_back({inlier.landmark, view_.normalized[inlier.feature].cast<double>(), p.z(),
                          levels_.sigma_px(view_.features.keypoints[inlier.feature].level) * pixel});
  }
  return parallax_.add(stamp_ns, again.T_map_camera, sightings_);
}

// One look-alike every few frames: where there are several each has its turn, and where there are none nothing is spent.
bool Localizer::withstands_a_rival(Candidate* candidate, std::uint64_t seed) {
  const std::size_t turn = rival_turn_++;
  if (turn % kFramesPerRival != 0) return true;
  const auto rivals = rivals_.of(candidate->evidence.T_map_camera);
  if (rivals.empty()) return true;
  const Rigid3 T_map_rival = rivals[turn / kFramesPerRival % rivals.size()];
  const Hypothesis found = found_[best_of_found()];
  found_.clear();
  const auto matches = solver_.search_by_projection(&landmarks_, T_map_rival, static_cast<float>(options_.numbers.rival_radius_px));
  keep(solver_.solve_and_refine(&landmarks_, matches, seed));
  found_.back().is_look_alike = true;
  const double lead = lead_of(found_, found, apart());
  if (std::isfinite(lead)) candidate->standing.lead = lead;
  return gate_.withstands(*candidate, T_map_rival, lead);
}

void Localizer::solve(const Proposal& proposal, std::uint64_t seed) {
  if (proposal.num_keyframes == 0) {
    const auto matches = solver_.search_by_projection(&landmarks_, proposal.T_map_camera, proposal.radius_px);
    return keep(solver_.solve_and_refine(&landmarks_, matches, seed));
  }
  gather_candidates(proposal);
  const auto matches = solver_.match_candidates();
  const PoseEvidence found = solver_.solve_and_refine(&landmarks_, matches, seed);
  keep(found);
  if (found.is_found && found.num_inliers < options_.numbers.thin_inliers)
    keep(solver_.solve_and_refine(&landmarks_, matches, seed, &found.T_map_camera));
}

void Localizer::gather_candidates(const Proposal& place) {
  CandidateSet& candidates = solver_.candidates();
  candidates.clear();
  ++visit_;
  for (const std::uint32_t keyframe : place.places()) {
    const std::size_t count = map_->keyframe_landmarks(keyframe, list_);
    for (const std::uint32_t landmark : std::span(list_).first(count)) {
      if (visit_of_landmark_[landmark] == visit_) continue;
      visit_of_landmark_[landmark] = visit_;
      const float angle_rad = MapView::angle_rad(map_->landmarks()[landmark]);
      for (const Descriptor& descriptor : map_->landmark_descriptors(landmark)) {
        if (!candidates.add(descriptor, static_cast<std::int32_t>(landmark), angle_rad)) return;
      }
    }
  }
}

void Localizer::keep(const PoseEvidence& found) {
  if (!found.is_found && !found_.empty()) return;
  found_.push_back({found, {}, {}, false});
  if (found.is_found) solver_.explained_features(landmarks_, &found_.back().explained, &found_.back().distinct);
}

// Matches with another place ask for any focal length: only what could be a pose has a say.
void Localizer::watch_calibration(const PoseEvidence& evidence) {
  if (!evidence.has_focal_scale || evidence.num_inliers < options_.numbers.min_inliers) return;
  calibration_.add(evidence.focal_scale, evidence.focal_scale_sigma);
}

const Localization& Localizer::accept(const Frame& frame, const Candidate& candidate, const char* proposed_by) {
  result_.state = State::kLocalized;
  result_.proposed_by = proposed_by;
  coarse_.reset();
  shared_covariance_ = candidate.evidence.shared_covariance;
  last_risk_features_ = risk_features(candidate.evidence, candidate.standing, candidate.is_continuation);
  set_pose(candidate.evidence.T_map_camera, candidate.evidence.covariance + shared_covariance_, last_risk_features_);
  result_.quality = quality_of(candidate.evidence, candidate.standing.margin);
  if (!candidate.is_continuation) ++result_.reset_counter;
  result_.jump_m = gate_.accept(frame.stamp_ns, candidate);
  parallax_.reset();
  return report(candidate);
}

const Localization& Localizer::decline(const Frame& frame, const Candidate& candidate) {
  result_.state = State::kLost;
  if (const auto predicted = gate_.predict(frame.stamp_ns, options_.max_coast_ns)) {
    result_.state = State::kCoasting;
    set_pose(predicted->T_map_camera, predicted->covariance + shared_covariance_, last_risk_features_);
  } else if (candidate.evidence.is_found && candidate.evidence.num_inliers >= options_.numbers.min_coarse_inliers) {
    result_.state = State::kCoarse;
    const Matrix6d covariance = candidate.evidence.covariance + candidate.evidence.shared_covariance;
    set_pose(candidate.evidence.T_map_camera, covariance, risk_features(candidate.evidence, candidate.standing, candidate.is_continuation));
    // The risk is that of the candidate; what is published beside it is a hint for people.
    result_.covariance += coarse_uncertainty();
    result_.protection = protection_of(result_.covariance);
  } else if (coarse_ && coarse_->is_current(frame.stamp_ns)) {
    result_.state = State::kCoarse;
    set_coarse_pose(frame.stamp_ns);
  }
  return report(candidate);
}

const Localization& Localizer::report(const Candidate& candidate) {
  result_.reason = candidate.reason;
  result_.is_tracked = candidate.is_continuation;
  result_.evidence = candidate.evidence;
  result_.standing = candidate.standing;
  timer_.finish(Stage::kVerify);
  result_.stage_ns = timer_.stop();
  return result_;
}

void Localizer::set_pose(const Rigid3& T_map_camera, const Matrix6d& covariance, const RiskFeatures& features) {
  result_.has_pose = true;
  result_.T_map_camera = T_map_camera;
  result_.covariance = with_map_uncertainty(covariance);
  result_.integrity_risk = integrity_risk(features, result_.covariance);
  result_.protection = protection_of(result_.covariance);
  result_.quality = 0;
}

// Nothing in this frame speaks for it: its risk is that of no pose.
void Localizer::set_coarse_pose(std::int64_t stamp_ns) {
  result_.has_pose = true;
  result_.T_map_camera = coarse_->T_map_camera;
  result_.covariance = with_map_uncertainty(coarse_->covariance_at(stamp_ns));
  result_.integrity_risk = 1;
  result_.protection = protection_of(result_.covariance);
  result_.quality = 0;
}

Matrix6d Localizer::with_map_uncertainty(const Matrix6d& covariance) const {
  Matrix6d total = covariance;
  total.diagonal().head<3>().array() += map_->info().pose_sigma_m * map_->info().pose_sigma_m;
  total.diagonal().tail<3>().array() += map_->info().pose_sigma_rad * map_->info().pose_sigma_rad;
  return total;
}

}  // namespace camloc
