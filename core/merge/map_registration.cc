// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/merge/map_registration.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/map/keyframe_view.h"

namespace camloc {
namespace {

constexpr std::uint32_t kMaxQueries = 400;   // keyframes asked without a prediction, evenly spread
constexpr int kNumRetrieved = 40;            // places that look alike
constexpr std::uint32_t kNumCandidates = 6;  // of those, not yet part of another one's surroundings, asked for geometry
constexpr std::uint32_t kKeyframesPerPlace = 6;
constexpr std::size_t kMaxLandmarksOfPlace = 3000;
constexpr std::uint32_t kMinShared = 20;  // landmarks that make two keyframes neighbours
constexpr PlaceLimits kLimits{.min_inliers = 30, .min_inlier_ratio = 0.3, .min_depth_agreement = 0.6};
// How far two fixes may differ in the motion between the maps, and more for each metre between them: they are bent against each
// other by their drift.
constexpr double kAgreementM = 0.10, kAgreementRad = 0.04, kDriftPerM = 0.02, kDriftRadPerM = 0.002;
constexpr std::size_t kMinFixes = 4;                      // that agree
constexpr double kMinExtentM = 0.5, kMinExtentRad = 0.5;  // over which those are spread, one of the two
constexpr double kMaxRivalGroupShare = 0.5;               // of fixes that agree on another motion
constexpr float kGuidedRadiusPx = 25;                     // of the look around a predicted pose
constexpr int kGuidedPasses = 3;
constexpr double kMetresPerRadian = 2;  // how much a turn counts against a step in "nearest keyframe"
constexpr double kNearestM = 6;         // keyframes farther off show another place

std::size_t longest_list(const MapData& map) {
  std::size_t longest = 1;
  for (const MapKeyframe& keyframe : map.keyframes) longest = std::max(longest, keyframe.landmarks.size());
  return longest;
}

double distance_between(const Rigid3& a, const Rigid3& b) {
  return (a.translation - b.translation).norm() + kMetresPerRadian * rotation_distance_rad(a.rotation, b.rotation);
}

class MapRegistration {
 public:
  MapRegistration(const MapView& a, const MapData& a_data, const MapData& b)
      : a_(a_data),
        b_(b),
        retriever_(a, static_cast<int>(longest_list(b))),
        solver_(b.camera, PyramidLevels(b.orb_scale_factor, static_cast<int>(b.orb_num_levels)),
                mapping_solver_options(static_cast<int>(longest_list(b)))),
        neighbours_(find_covisible_keyframes(a_data, kMinShared)),
        place_(b.camera.color, PyramidLevels(a_data.orb_scale_factor, static_cast<int>(a_data.orb_num_levels))) {}

  /// First a sample of the keyframes without any prediction; what they agree on predicts all the others.
  Result<std::vector<KeyframeFix>> run(WorkObserver& observer, MapRegistrationReport* report) {
    const Status cancelled(ErrorCode::kUnavailable, "interrupted");
    const auto num_keyframes = static_cast<std::uint32_t>(b_.keyframes.size());
    const std::uint32_t num_queries = std::min(num_keyframes, kMaxQueries);
    std::vector<KeyframeFix> fixes;
    for (std::uint32_t q = 0; q < num_queries; ++q) {
      if (!observer.on_progress("looking for places in common, keyframe", q + 1, num_queries)) return cancelled;
      const auto keyframe = static_cast<std::uint32_t>(std::uint64_t{q} * num_keyframes / num_queries);
      if (const auto fix = find_anywhere(keyframe)) fixes.push_back(*fix);
    }
    report->num_queries = num_queries;
    report->num_convincing = static_cast<std::uint32_t>(fixes.size());
    if (const Status consistent = keep_consistent(&fixes); !consistent.is_ok()) return consistent;
    report->num_disagreeing = report->num_convincing - static_cast<std::uint32_t>(fixes.size());

    std::vector<std::uint8_t> is_fixed(num_keyframes, 0);
    for (const KeyframeFix& fix : fixes) is_fixed[fix.keyframe] = 1;
    for (int pass = 0; pass < kGuidedPasses; ++pass) {
      const std::vector<KeyframeFix> known = fixes;
      for (std::uint32_t k = 0; k < num_keyframes; ++k) {
        if (is_fixed[k] != 0) continue;
        if (!observer.on_progress("localizing in the first map, keyframe", k + 1, num_keyframes)) return cancelled;
        const KeyframeFix& near = nearest_fix(known, k);
        const auto fix = find_around(k, near.T_a_camera * T_b_camera(near.keyframe).inverse() * T_b_camera(k));
        if (!fix || !agree(near, *fix)) continue;
        fixes.push_back(*fix);
        is_fixed[k] = 1;
      }
      if (fixes.size() == known.size()) break;
    }
    std::sort(fixes.begin(), fixes.end(), [](const KeyframeFix& i, const KeyframeFix& j) { return i.keyframe < j.keyframe; });
    return fixes;
  }

 private:
  std::optional<KeyframeFix> find_anywhere(std::uint32_t keyframe) {
    const KeyframeView query = view_of_keyframe(b_, keyframe);
    std::vector<Registration> candidates;
    std::vector<std::uint8_t> is_covered(a_.keyframes.size(), 0);
    std::uint32_t num_tried = 0;
    const auto retrieved = retriever_.retrieve(query.view.features.descriptors, kNumRetrieved);
    for (const RankedKeyframe& place : retrieved) {
      if (is_covered[place.keyframe] != 0) continue;
      if (num_tried++ == kNumCandidates) break;
      const std::vector<std::uint32_t> keyframes = surroundings_of(place.keyframe);
      for (const std::uint32_t k : keyframes) is_covered[k] = 1;
      assign_place(keyframes);
      Registration found = register_anywhere(query.view, keyframe, &place_, &solver_);
      if (found.is_found) candidates.push_back(std::move(found));
    }
    const auto best = std::max_element(candidates.begin(), candidates.end(),
                                       [](const Registration& i, const Registration& j) { return i.num_inliers < j.num_inliers; });
    if (best == candidates.end() || !is_convincing(*best, kLimits)) return std::nullopt;
    const bool has_rival =
        std::any_of(candidates.begin(), candidates.end(), [&](const Registration& other) { return is_strong_rival(other, *best); });
    if (has_rival) return std::nullopt;
    return KeyframeFix{keyframe, best->T_map_camera, best->covariance, best->num_inliers};
  }

  std::optional<KeyframeFix> find_around(std::uint32_t keyframe, const Rigid3& T_a_camera_predicted) {
    std::vector<std::pair<double, std::uint32_t>> near;
    for (std::uint32_t k = 0; k < a_.keyframes.size(); ++k) {
      const double distance = distance_between(a_.keyframes[k].T_map_camera, T_a_camera_predicted);
      if (distance < kNearestM) near.emplace_back(distance, k);
    }
    std::sort(near.begin(), near.end());
    if (near.size() > kKeyframesPerPlace) near.resize(kKeyframesPerPlace);
    std::vector<std::uint32_t> keyframes;
    for (const auto& [distance, k] : near) keyframes.push_back(k);
    if (keyframes.empty()) return std::nullopt;
    assign_place(keyframes);
    const Registration found =
        register_near(view_of_keyframe(b_, keyframe).view, T_a_camera_predicted, kGuidedRadiusPx, keyframe, &place_, &solver_);
    if (!is_convincing(found, kLimits)) return std::nullopt;
    return KeyframeFix{keyframe, found.T_map_camera, found.covariance, found.num_inliers};
  }

  /// The fixes that agree with the one that most agree with; refused where a second group is nearly as large.
  Status keep_consistent(std::vector<KeyframeFix>* fixes) const {
    const auto group_of = [&](const std::vector<KeyframeFix>& all) {
      std::vector<KeyframeFix> largest, group;
      for (const KeyframeFix& i : all) {
        group.clear();
        for (const KeyframeFix& j : all) {
          if (agree(i, j)) group.push_back(j);
        }
        if (group.size() > largest.size()) largest = group;
      }
      return largest;
    };
    const std::vector<KeyframeFix> group = group_of(*fixes);
    if (group.size() < kMinFixes || !is_spread(group)) {
      const std::string found = std::to_string(group.size()) + " keyframe" + (group.size() == 1 ? "" : "s");
      const std::string why = group.size() < kMinFixes ? found + " agree on where they are, " + std::to_string(kMinFixes) + " are needed"
                                                       : found + " agree on where they are, but all of one spot";
      return {ErrorCode::kInvalid,
              "the two maps have no place in common that was seen with certainty (" + why + "); record a stretch that both walks share"};
    }
    std::vector<KeyframeFix> others;
    for (const KeyframeFix& fix : *fixes) {
      if (std::none_of(group.begin(), group.end(), [&](const KeyframeFix& g) { return g.keyframe == fix.keyframe; })) others.push_back(fix);
    }
    const std::size_t num_rivals = group_of(others).size();
    if (static_cast<double>(num_rivals) > kMaxRivalGroupShare * static_cast<double>(group.size())) {
      return {ErrorCode::kInvalid, "the two maps fit together in two ways, by " + std::to_string(group.size()) + " and by " +
                                       std::to_string(num_rivals) +
                                       " keyframes: the building repeats itself; record a stretch that tells "
                                       "the places apart"};
    }
    *fixes = group;
    return Status::ok();
  }

  std::vector<std::uint32_t> surroundings_of(std::uint32_t place) const {
    std::vector<std::uint32_t> keyframes = {place};
    for (const CovisibleKeyframe& neighbour : neighbours_[place]) {
      if (keyframes.size() >= kKeyframesPerPlace) break;
      keyframes.push_back(neighbour.keyframe);
    }
    return keyframes;
  }

  void assign_place(const std::vector<std::uint32_t>& keyframes) {
    place_.clear();
    std::vector<std::uint8_t> is_in(a_.landmarks.size(), 0);
    for (const std::uint32_t k : keyframes) {
      for (const std::uint32_t i : a_.keyframes[k].landmarks) {
        const MapLandmark& landmark = a_.landmarks[i];
        if (is_in[i] == 0 && place_.size() < kMaxLandmarksOfPlace) {
          place_.add({i, landmark.position_m.cast<double>(), landmark.direction.cast<double>(), landmark.min_reference_m,
                      landmark.max_reference_m, landmark.angle_rad, landmark.descriptors});
        }
        is_in[i] = 1;
      }
    }
  }

  /// Do both ask for the same motion between the maps, as far as these are straight?
  bool agree(const KeyframeFix& i, const KeyframeFix& j) const {
    const Rigid3 T_i_j = T_b_camera(i.keyframe).inverse() * T_b_camera(j.keyframe);
    const Rigid3 predicted = i.T_a_camera * T_i_j;
    const double apart_m = T_i_j.translation.norm();
    return (predicted.translation - j.T_a_camera.translation).norm() <= kAgreementM + kDriftPerM * apart_m &&
           rotation_distance_rad(predicted.rotation, j.T_a_camera.rotation) <= kAgreementRad + kDriftRadPerM * apart_m;
  }

  bool is_spread(const std::vector<KeyframeFix>& fixes) const {
    for (const KeyframeFix& fix : fixes) {
      const Rigid3 T = T_b_camera(fixes.front().keyframe).inverse() * T_b_camera(fix.keyframe);
      if (T.translation.norm() >= kMinExtentM || rotation_distance_rad(T.rotation, Eigen::Quaterniond::Identity()) >= kMinExtentRad)
        return true;
    }
    return false;
  }

  const KeyframeFix& nearest_fix(const std::vector<KeyframeFix>& fixes, std::uint32_t keyframe) const {
    const KeyframeFix* nearest = nullptr;
    double least = std::numeric_limits<double>::infinity();
    for (const KeyframeFix& fix : fixes) {
      const double distance = distance_between(T_b_camera(fix.keyframe), T_b_camera(keyframe));
      if (distance >= least) continue;
      least = distance;
      nearest = &fix;
    }
    return *nearest;
  }

  [[nodiscard]] const Rigid3& T_b_camera(std::uint32_t keyframe) const { return b_.keyframes[keyframe].T_map_camera; }

  const MapData& a_;
  const MapData& b_;
  Retriever retriever_;
  PoseSolver solver_;
  std::vector<std::vector<CovisibleKeyframe>> neighbours_;  ///< of A's keyframes
  LandmarkSet place_;
};

}  // namespace

Result<std::vector<KeyframeFix>> register_map(const MapView& a, const MapData& a_data, const MapData& b, WorkObserver& observer,
                                              MapRegistrationReport* report) {
  return MapRegistration(a, a_data, b).run(observer, report);
}

std::vector<std::vector<CovisibleKeyframe>> find_covisible_keyframes(const MapData& map, std::uint32_t min_shared) {
  std::vector<std::vector<std::uint32_t>> keyframes_of(map.landmarks.size());
  for (std::uint32_t k = 0; k < map.keyframes.size(); ++k) {
    for (const std::uint32_t i : map.keyframes[k].landmarks) keyframes_of[i].push_back(k);
  }
  std::vector<std::vector<CovisibleKeyframe>> covisible(map.keyframes.size());
  std::vector<std::uint32_t> count(map.keyframes.size());
  for (std::uint32_t k = 0; k < map.keyframes.size(); ++k) {
    std::fill(count.begin(), count.end(), 0U);
    for (const std::uint32_t i : map.keyframes[k].landmarks) {
      for (const std::uint32_t other : keyframes_of[i]) ++count[other];
    }
    for (std::uint32_t other = 0; other < count.size(); ++other) {
      if (other != k && count[other] >= std::max(min_shared, 1U)) covisible[k].push_back({other, count[other]});
    }
    std::stable_sort(covisible[k].begin(), covisible[k].end(),
                     [](const CovisibleKeyframe& i, const CovisibleKeyframe& j) { return i.num_shared > j.num_shared; });
  }
  return covisible;
}

}  // namespace camloc
