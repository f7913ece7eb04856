// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Read place_view() first. A frame is tracked against the landmarks around the last keyframe; where that fails, it is looked for by
// its words, then followed by dense alignment (depth_bridge), and after some lost frames a new segment begins. A frame that shows
// enough that is new becomes a keyframe: it gets landmarks, its window is adjusted, and a loop is looked for. finish() adjusts all.
#include "core/slam/slam.h"

#include <algorithm>

#include "core/geometry/pose_refinement.h"
#include "core/slam/keyframe_insertion.h"
#include "core/slam/observation_refinement.h"

namespace camloc {
namespace {

// Common landmarks of two frames one after the other.
constexpr std::uint32_t kStrongLink = 150;

// Bridged frames become keyframes when they show something new: so far from the last one.
constexpr double kBridgedKeyframeM = 0.15, kBridgedKeyframeRad = 0.1;
constexpr std::uint32_t kBridgedNeighbours = 3;  // keyframes before it that its few features are compared with
constexpr float kBridgedRadiusPx = 8;

std::size_t num_with_depth(const FrameFeatures& view) {
  return static_cast<std::size_t>(std::count_if(view.depth_m.begin(), view.depth_m.end(), [](float z) { return z > 0; }));
}

}  // namespace

Slam::Slam(const RgbdCamera& camera, const SlamOptions& options)
    : camera_(camera),
      options_(options),
      map_(camera, options.orb.scale_factor, options.orb.num_levels),
      solver_(camera, map_.levels(), mapping_solver_options(options.orb.num_features, options.numbers.depth_in_tracking != 0)),
      tracker_(options.numbers, &map_, &solver_),
      loops_(options.numbers, &map_, &solver_),
      bridge_(camera, options.numbers),
      links_(camera),
      depth_weight_(options.numbers.depth_share) {}

FrameReport Slam::add_view(std::uint64_t frame, const FrameFeatures& view, const Thumbnail& thumbnail) {
  const FrameReport report = place_view(frame, view, thumbnail);
  if (report.is_keyframe && !report.is_bridged)
    links_.add_keyframe(map_, static_cast<std::uint32_t>(map_.keyframes().size()) - 1, thumbnail);
  return report;
}

FrameReport Slam::place_view(std::uint64_t frame, const FrameFeatures& view, const Thumbnail& thumbnail) {
  FrameReport report;
  ++counts_.num_views;
  if (map_.keyframes().empty()) {
    if (begin_segment(frame, view, &report))
      begin_bridge(view.stamp_ns, thumbnail);
    else
      ++counts_.num_lost;
    return report;
  }
  const bool was_lost = num_lost_in_a_row_ > 0;
  Registration found = tracker_.track(view, frame);
  if (!found.is_found && (was_lost || bridge_.is_open())) found = tracker_.relocalize(view, places_, frame);
  if (!found.is_found && !was_lost && go_on_by_depth(frame, view, thumbnail, &report)) return report;
  if (!found.is_found) {
    bridge_.forget();
    if (num_lost_in_a_row_++ == 0) ++counts_.num_losses;
    tracker_.forget_motion();
    if (num_lost_in_a_row_ > options_.numbers.max_lost_views && begin_segment(frame, view, &report)) {
      begin_bridge(view.stamp_ns, thumbnail);
      return report;
    }
    ++counts_.num_lost;
    return report;
  }
  num_lost_in_a_row_ = 0;
  report.state = ViewState::kTracked;
  report.num_inliers = found.num_inliers;
  tracker_.accept(view.stamp_ns, found.T_map_camera);
  const bool is_required = std::binary_search(options_.required_keyframes.begin(), options_.required_keyframes.end(), frame);
  if (is_required || tracker_.wants_keyframe(view, found)) {
    add_keyframe(frame, view, found, &report);
  } else {
    remember(frame, view.stamp_ns, false, seen_in(view, found.inliers));
  }
  begin_bridge(view.stamp_ns, thumbnail);
  return report;
}

// The next frame may need this one.
void Slam::begin_bridge(std::int64_t stamp_ns, const Thumbnail& thumbnail) {
  bridge_.begin_at(stamp_ns, thumbnail);
  bridge_begin_ = {tracker_.reference(), tracker_.T_reference_camera()};
}

// A frame full of features that fit nothing is a riddle, no bare wall: only a bridge may lead to one.
bool Slam::go_on_by_depth(std::uint64_t frame, const FrameFeatures& view, const Thumbnail& thumbnail, FrameReport* report) {
  const bool is_bare = num_with_depth(view) < options_.numbers.min_segment_features;
  if (!is_bare && !bridge_.is_open()) return false;
  const Rigid3 T_map_begin = map_.T_map_camera(bridge_begin_.reference) * bridge_begin_.T_reference_camera;
  const auto step = bridge_.step(view.stamp_ns, thumbnail, T_map_begin.inverse() * tracker_.predict(view.stamp_ns));
  if (!step) return false;
  report->state = ViewState::kTracked;
  report->is_bridged = true;
  ++counts_.num_bridged;
  tracker_.accept(view.stamp_ns, T_map_begin * step->T_begin_camera);
  const Rigid3 T_last_camera = map_.keyframes().back().view.T_map_camera.inverse() * T_map_begin * step->T_begin_camera;
  const bool is_new_sight = T_last_camera.translation.norm() > kBridgedKeyframeM ||
                            rotation_distance_rad(T_last_camera.rotation, Eigen::Quaterniond::Identity()) > kBridgedKeyframeRad;
  if (is_bare && !is_new_sight) {
    remember(frame, view.stamp_ns, false);
    return true;
  }
  const std::uint32_t keyframe = add_bridged_keyframe(frame, view, thumbnail, *step);
  report->is_keyframe = true;
  if (!is_bare) {  // features again, but of nothing that is known: the map goes on from here
    tracker_.set_reference(keyframe);
    report->loop = look_for_loop(keyframe);
    tracker_.refresh();
    begin_bridge(view.stamp_ns, thumbnail);
  }
  places_.add(view.features.descriptors);
  return true;
}

// Held by dense links, and by what few features it shares with those before.
std::uint32_t Slam::add_bridged_keyframe(std::uint64_t frame, FrameFeatures view, const Thumbnail& thumbnail,
                                         const DepthBridge::Step& step) {
  const std::uint32_t before = bridge_begin_.reference, last = static_cast<std::uint32_t>(map_.keyframes().size()) - 1;
  const Rigid3 T_before_camera = bridge_begin_.T_reference_camera * step.T_begin_camera;
  view.T_map_camera = map_.T_map_camera(before) * T_before_camera;
  const std::uint32_t segment = map_.keyframe(before).segment;
  const std::uint32_t keyframe = insert_keyframe(frame, segment, view, {}, &map_);
  std::vector<std::uint32_t> nearby;
  for (std::uint32_t back = 0; back < std::min(kBridgedNeighbours, last + 1); ++back) {
    if (map_.keyframe(last - back).segment == segment) nearby.push_back(last - back);
  }
  LandmarkSet landmarks = map_.empty_landmark_set();
  map_.collect_landmarks(nearby, kMaxLocalLandmarks, &landmarks);
  fuse_into_keyframe(&landmarks, keyframe, kBridgedRadiusPx, &solver_, &map_);
  const Matrix6d covariance = rotate_covariance(bridge_begin_.T_reference_camera.rotation, step.covariance);
  loops_.add_link({before, keyframe, T_before_camera, covariance + link_covariance(T_before_camera, kStrongLink)});
  if (links_.add_keyframe(map_, keyframe, thumbnail) == 0) links_.add({before, keyframe, T_before_camera, covariance});
  tracked_.push_back({frame, view.stamp_ns, keyframe, {}, true, {}});
  return keyframe;
}

bool Slam::begin_segment(std::uint64_t frame, FrameFeatures view, FrameReport* report) {
  if (num_with_depth(view) < options_.numbers.min_segment_features) return false;
  SegmentBegin begin;
  begin.first_keyframe = static_cast<std::uint32_t>(map_.keyframes().size());
  begin.has_before = !map_.keyframes().empty();
  if (begin.has_before) {
    begin.keyframe_before = tracker_.reference();
    begin.T_before_camera = tracker_.T_reference_camera();
    begin.gap_s = 1e-9 * static_cast<double>(view.stamp_ns - tracked_.back().stamp_ns);
  }
  loops_.begin_segment(begin);
  const std::uint32_t segment = counts_.num_segments++;
  view.T_map_camera = {};
  num_lost_in_a_row_ = 0;
  report->state = ViewState::kTracked;
  report->has_begun_segment = report->is_keyframe = true;
  const std::uint32_t keyframe = insert_keyframe(frame, segment, view, {}, &map_);
  places_.add(view.features.descriptors);
  tracker_.set_reference(keyframe);
  tracker_.accept(view.stamp_ns, view.T_map_camera);
  tracker_.forget_motion();
  remember(frame, view.stamp_ns, true);
  return true;
}

void Slam::add_keyframe(std::uint64_t frame, FrameFeatures view, const Registration& tracked, FrameReport* report) {
  view.T_map_camera = tracked.T_map_camera;
  report->is_keyframe = true;
  const std::uint32_t keyframe = insert_keyframe(frame, map_.keyframe(tracker_.reference()).segment, view, tracked.inliers, &map_);
  fuse_with_neighbours(keyframe, &solver_, &map_);
  add_far_landmarks(options_.numbers, keyframe, &map_);
  tracker_.set_reference(keyframe);
  remember(frame, view.stamp_ns, true);
  adjust_around(keyframe);
  report->loop = look_for_loop(keyframe);
  if (report->loop.is_closed) adjust_around(keyframe);
  places_.add(view.features.descriptors);
  tracker_.refresh();
}

// A frame that was tracked, and what it saw.
void Slam::remember(std::uint64_t frame, std::int64_t stamp_ns, bool is_keyframe, std::vector<TrackedFrame::Seen> seen) {
  tracked_.push_back({frame, stamp_ns, tracker_.reference(), tracker_.T_reference_camera(), is_keyframe, std::move(seen)});
}

std::vector<Slam::TrackedFrame::Seen> Slam::seen_in(const FrameFeatures& view, const std::vector<LandmarkObservation>& pairs) const {
  std::vector<TrackedFrame::Seen> seen;
  seen.reserve(pairs.size());
  for (const LandmarkObservation& pair : pairs) {
    seen.push_back({pair.landmark, view.normalized[pair.feature].x(), view.normalized[pair.feature].y(), view.depth_m[pair.feature],
                    map_.levels().sigma_px(view.features.keypoints[pair.feature].level)});
  }
  return seen;
}

SlamCounts Slam::counts() const {
  SlamCounts counts = counts_;
  counts.num_keyframes = static_cast<std::uint32_t>(map_.keyframes().size());
  counts.num_landmarks = map_.num_alive_landmarks();
  return counts;
}

void Slam::adjust_around(std::uint32_t keyframe) {
  depth_weight_.observe(adjust_locally(bundle_options(), options_.numbers, keyframe, &map_).median_depth_sigmas);
}

BundleOptions Slam::bundle_options() const {
  BundleOptions bundle;
  bundle.focal_px = camera_.color.mean_focal_px();
  bundle.depth_noise = depth_weight_.weighted(camera_.depth_noise);
  bundle.use_depth = options_.numbers.depth_in_adjustment != 0;
  bundle.pixel_kernel_sigmas = options_.numbers.pixel_kernel_sigmas;
  bundle.depth_kernel_sigmas = options_.numbers.depth_kernel_sigmas;
  bundle.max_dense_cameras = options_.numbers.max_dense_cameras;
  return bundle;
}

// Keyframes are final; the frames between them are refined on the final landmarks.
Rigid3 Slam::final_pose(const TrackedFrame& view) const {
  const Rigid3 T_map_camera = map_.T_map_camera(view.reference) * view.T_reference_camera;
  if (view.is_keyframe) return T_map_camera;
  Correspondences pairs(view.seen.size());
  for (const TrackedFrame::Seen& seen : view.seen) {
    const std::int32_t landmark = map_.resolve(seen.landmark);
    if (landmark == kNoLandmark) continue;
    const Eigen::Vector3f p = map_.landmark(static_cast<std::uint32_t>(landmark)).position_m.cast<float>();
    pairs.add(seen.x, seen.y, p.x(), p.y(), p.z(), seen.depth_m, seen.sigma_px, 0, 0, landmark);
  }
  PoseRefinementOptions refinement;
  refinement.depth_noise = camera_.depth_noise;
  refinement.use_depth = options_.numbers.depth_in_tracking != 0;
  const PoseRefinementResult refined = refine_pose(pairs, T_map_camera, camera_.color.mean_focal_px(), refinement, nullptr);
  const bool is_better = refined.is_converged && refined.num_inliers >= static_cast<int>(view.seen.size()) / 2;
  return is_better ? refined.T_map_camera : T_map_camera;
}

// What was not known yet when a segment was processed may join it now; then its keyframes may find what else they overlap with,
// and the more of them do, the better the segment is turned into place.
void Slam::join_leftover_segments() {
  if (options_.numbers.close_loops == 0 || counts_.num_segments == counts_.num_joined + 1) return;
  const std::uint32_t main_segment = map_.keyframes().empty() ? 0 : map_.keyframe(0).segment;
  std::vector<std::uint32_t> leftover;
  for (std::uint32_t k = 0; k < map_.keyframes().size(); ++k) {
    if (map_.keyframe(k).segment != main_segment) leftover.push_back(k);
  }
  for (const std::uint32_t k : leftover) {
    if (map_.keyframe(k).segment != main_segment) look_for_loop(k);
  }
  for (const std::uint32_t k : leftover) {
    if (map_.keyframe(k).segment == main_segment) look_for_loop(k);
  }
}

LoopReport Slam::look_for_loop(std::uint32_t keyframe) {
  if (options_.numbers.close_loops == 0) return {};
  const LoopReport loop = loops_.consider(keyframe, places_);
  if (loop.is_closed) ++counts_.num_loops;
  if (loop.is_joined) ++counts_.num_joined;
  if (loop.is_refused) ++counts_.num_loops_refused;
  return loop;
}

// Pixels are not needed any more afterwards.
void Slam::refine_all_observations() {
  if (options_.numbers.refine_observations != 0) (void)refine_observations(&map_);
  for (std::uint32_t k = 0; k < map_.keyframes().size(); ++k) map_.keyframe(k).view.patches = {};
}

// Dense links are depth, too.
MapEvidence Slam::evidence(std::uint32_t segment) const {
  MapEvidence evidence;
  if (segment == controlled_segment_) evidence.controls = controls_;
  if (options_.numbers.depth_in_adjustment != 0) evidence.links = links_.links();
  return evidence;
}

SlamResult Slam::finish(const BundleCallback& on_iteration) {
  join_leftover_segments();
  refine_all_observations();
  fits_.clear();
  controls_.clear();
  for (const SlamKeyframe& keyframe : map_.keyframes()) fits_[keyframe.segment];
  for (auto& [segment, fit] : fits_)
    fit = adjust_globally(bundle_options(), segment, evidence(segment), options_.numbers.final_max_pixel_sigmas, &map_, on_iteration);
  return result();
}

SlamResult Slam::adjust_to(std::span<const ControlLandmark> controls, const BundleCallback& on_iteration) {
  if (!controls.empty() && !controls.front().seen.empty()) {
    const std::uint32_t segment = map_.keyframe(controls.front().seen.front().keyframe).segment;
    controls_.assign(controls.begin(), controls.end());
    controlled_segment_ = segment;
    fits_[segment] =
        adjust_globally(bundle_options(), segment, evidence(segment), options_.numbers.final_max_pixel_sigmas, &map_, on_iteration);
  }
  return result();
}

MapUncertainty Slam::uncertainty(std::uint32_t segment) const {
  return estimate_uncertainty(bundle_options(), extract_segment(segment, evidence(segment), map_));
}

std::optional<std::uint32_t> Slam::keyframe_of_frame(std::uint64_t frame) const {
  const auto keyframes = map_.keyframes();
  const auto place = std::lower_bound(keyframes.begin(), keyframes.end(), frame,
                                      [](const SlamKeyframe& keyframe, std::uint64_t wanted) { return keyframe.frame < wanted; });
  if (place == keyframes.end() || place->frame != frame) return std::nullopt;
  return static_cast<std::uint32_t>(place - keyframes.begin());
}

SlamResult Slam::result() const {
  SlamResult result;
  std::map<std::uint32_t, SlamResult::Segment> segments;
  for (const SlamKeyframe& keyframe : map_.keyframes()) ++segments[keyframe.segment].num_keyframes;
  for (const TrackedFrame& view : tracked_) {
    const std::uint32_t segment = map_.keyframe(view.reference).segment;
    const auto num_inliers = static_cast<std::uint32_t>(view.seen.size());
    result.poses.push_back({view.frame, view.stamp_ns, segment, final_pose(view), num_inliers, view.is_keyframe});
    ++segments[segment].num_views;
  }
  for (auto& [id, segment] : segments) {
    segment.id = id;
    if (const auto fit = fits_.find(id); fit != fits_.end()) segment.fit = fit->second;
    result.segments.push_back(segment);
  }
  std::stable_sort(result.segments.begin(), result.segments.end(),
                   [](const SlamResult::Segment& a, const SlamResult::Segment& b) { return a.num_views > b.num_views; });
  return result;
}

}  // namespace camloc
