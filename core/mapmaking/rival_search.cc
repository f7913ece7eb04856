// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapmaking/rival_search.h"

#include <algorithm>
#include <array>
#include <utility>

#include "core/features/hamming.h"
#include "core/registration/rivals.h"

namespace camloc {
namespace {

constexpr int kMaxPairs = 1000;
constexpr int kRansacIterations = 300;
constexpr double kMaxErrorPx = 5.0;
/// Keyframes this close show the same place: one of them is asked.
constexpr RivalDistance kSamePlace{.position_m = 1.0, .rotation_rad = 0.5};
/// Places with fewer inliers are not alike: mutual matches of different rooms agree on a pose of up to a dozen by chance.
constexpr std::uint32_t kMinRivalInliers = 18;
constexpr std::size_t kMaxRivals = 8;  // kept of each keyframe

std::vector<KeyframeView> views_of(const MapData& map) {
  std::vector<KeyframeView> views;
  for (std::uint32_t k = 0; k < map.keyframes.size(); ++k) views.push_back(view_of_keyframe(map, k));
  return views;
}

int most_features(const std::vector<KeyframeView>& views) {
  std::size_t most = 1;
  for (const KeyframeView& view : views) most = std::max(most, view.view.size());
  return static_cast<int>(most);
}

PoseSolverOptions solver_options(int max_features) {
  PoseSolverOptions solver;
  solver.max_features = max_features;
  solver.ransac_iterations = kRansacIterations;
  solver.max_ransac_pairs = kMaxPairs;
  solver.max_ransac_error_px = kMaxErrorPx;
  solver.gathers_evidence = false;
  return solver;
}

double common_share(const std::vector<std::uint32_t>& a, const std::vector<std::uint32_t>& b) {
  std::size_t common = 0;
  for (std::size_t i = 0, k = 0; i < a.size() && k < b.size();) {
    const std::uint32_t left = a[i], right = b[k];
    common += left == right ? 1 : 0;
    i += left <= right ? 1 : 0;
    k += right <= left ? 1 : 0;
  }
  return static_cast<double>(common) / static_cast<double>(std::max<std::size_t>(1, std::min(a.size(), b.size())));
}

bool is_other_place(const KeyframeView& a, const KeyframeView& b, const RivalSearchOptions& options) {
  return are_rivals(a.view.T_map_camera, b.view.T_map_camera, {options.distance_m, options.turn_rad}) &&
         common_share(a.landmarks, b.landmarks) <= options.max_common_share;
}

}  // namespace

RivalSearch::RivalSearch(const MapView& map, const MapData& data, const RivalSearchOptions& options)
    : positions_(data),
      options_(options),
      views_(views_of(data)),
      most_features_(most_features(views_)),
      retriever_(map, most_features_),
      forward_(static_cast<std::size_t>(most_features_)),
      backward_(static_cast<std::size_t>(most_features_)),
      solver_(data.camera, PyramidLevels(data.orb_scale_factor, static_cast<int>(data.orb_num_levels)), solver_options(most_features_)) {}

std::vector<RivalPlace> RivalSearch::find(std::uint32_t keyframe) {
  const KeyframeView& here = views_[keyframe];
  solver_.begin(here.view);
  std::vector<RivalPlace> places;
  for (const RankedKeyframe& retrieved : retriever_.retrieve(here.view.features.descriptors, static_cast<int>(views_.size()))) {
    const KeyframeView& there = views_[retrieved.keyframe];
    const bool is_asked = std::any_of(places.begin(), places.end(), [&](const RivalPlace& place) {
      return !are_rivals(views_[place.keyframe].view.T_map_camera, there.view.T_map_camera, kSamePlace);
    });
    if (is_asked || !is_other_place(here, there, options_)) continue;
    places.push_back(compare(here, retrieved.keyframe, keyframe));
    if (static_cast<int>(places.size()) == options_.max_compared) break;
  }
  return places;
}

RivalPlace RivalSearch::compare(const KeyframeView& here, std::uint32_t rival_keyframe, std::uint64_t seed) {
  const KeyframeView& there = views_[rival_keyframe];
  nearest_descriptors(here.view.features.descriptors, there.view.features.descriptors, forward_.data());
  const auto is_near = [&](const NearestDescriptor& nearest) { return nearest.distance <= options_.max_match_distance; };
  asked_back_.clear();
  for (std::size_t i = 0; i < here.landmarks.size(); ++i)
    if (is_near(forward_[i])) asked_back_.push_back(there.view.features.descriptors[forward_[i].index]);
  nearest_descriptors(asked_back_, here.view.features.descriptors, backward_.data());
  matches_.clear();
  auto back = backward_.begin();
  for (std::size_t i = 0; i < here.landmarks.size(); ++i) {
    const NearestDescriptor& nearest = forward_[i];
    if (!is_near(nearest) || (back++)->index != i) continue;
    const auto landmark = static_cast<std::int32_t>(there.landmarks[nearest.index]);
    const Eigen::Vector3f apart = positions_.position_m(static_cast<std::int32_t>(here.landmarks[i])) - positions_.position_m(landmark);
    if (apart.norm() < options_.same_point_m) continue;
    matches_.push_back({.feature = static_cast<std::int32_t>(i), .landmark = landmark, .distance = nearest.distance});
  }
  RivalPlace place{rival_keyframe, 0, static_cast<std::uint32_t>(matches_.size()), 0, {}};
  place.matched_share = static_cast<double>(matches_.size()) / static_cast<double>(std::max<std::size_t>(1, here.landmarks.size()));
  if (matches_.size() < options_.min_matches) return place;
  const PoseEvidence found = solver_.solve(positions_, matches_, seed);
  if (!found.is_found) return place;
  place.num_inliers = found.num_inliers;
  place.T_map_camera = found.T_map_camera;
  return place;
}

namespace {

/// Landmarks by place, to ask whether something like one of them is at another place.
class TwinFinder {
 public:
  explicit TwinFinder(const MapData& map) : map_(&map) {
    for (std::uint32_t i = 0; i < map.landmarks.size(); ++i) {
      const Eigen::Vector3f& p_map = map.landmarks[i].position_m;
      if (has_cell(p_map)) cells_.push_back({cell_of(p_map), i});
    }
    std::sort(cells_.begin(), cells_.end());
  }

  /// Is there, within kTwinRadiusM of `p_map`, a landmark that looks like this one?
  [[nodiscard]] bool has_twin_at(const MapLandmark& landmark, const Eigen::Vector3f& p_map) const {
    if (!has_cell(p_map)) return false;
    const Cell low = cell_of(p_map - Eigen::Vector3f::Constant(kTwinRadiusM)),
               high = cell_of(p_map + Eigen::Vector3f::Constant(kTwinRadiusM));
    for (int x = low[0]; x <= high[0]; ++x) {
      for (int y = low[1]; y <= high[1]; ++y) {
        auto at = std::lower_bound(cells_.begin(), cells_.end(), std::pair(Cell{x, y, low[2]}, 0U));
        for (; at != cells_.end() && at->first <= Cell{x, y, high[2]}; ++at) {
          const MapLandmark& other = map_->landmarks[at->second];
          if ((other.position_m - p_map).norm() <= kTwinRadiusM && is_alike(landmark, other)) return true;
        }
      }
    }
    return false;
  }

 private:
  using Cell = std::array<int, 3>;
  static constexpr float kTwinRadiusM = 0.1F;
  static constexpr int kMaxTwinDistance = 64;  // of 256 bits

  /// A file may say that a landmark is anywhere.
  static bool has_cell(const Eigen::Vector3f& p) { return (p.array().abs() < 1e6F).all(); }
  static Cell cell_of(const Eigen::Vector3f& p) {
    const Eigen::Vector3f cell = (p / (2 * kTwinRadiusM)).array().floor();
    return {static_cast<int>(cell.x()), static_cast<int>(cell.y()), static_cast<int>(cell.z())};
  }
  static bool is_alike(const MapLandmark& a, const MapLandmark& b) {
    return std::any_of(a.descriptors.begin(), a.descriptors.end(), [&](const Descriptor& ours) {
      return std::any_of(b.descriptors.begin(), b.descriptors.end(),
                         [&](const Descriptor& theirs) { return hamming_distance(ours, theirs) <= kMaxTwinDistance; });
    });
  }

  const MapData* map_;
  std::vector<std::pair<Cell, std::uint32_t>> cells_;
};

/// Landmarks of a keyframe that lie where the rival place repeats this one. One landmark alone says little, it may be mapped here and
/// not there: what counts is whether those around it have twins.
std::vector<std::uint32_t> repeated_landmarks(const MapData& map, const TwinFinder& twins, const MapKeyframe& keyframe,
                                              const RivalPlace& rival) {
  constexpr float kNeighbourhoodM = 0.2F;
  constexpr double kMinShare = 0.25;
  const Rigid3 T_there_here = rival.T_map_camera * keyframe.T_map_camera.inverse();
  std::vector<std::uint8_t> has_twin;
  for (const std::uint32_t i : keyframe.landmarks) {
    const MapLandmark& landmark = map.landmarks[i];
    has_twin.push_back(twins.has_twin_at(landmark, (T_there_here * landmark.position_m.cast<double>()).cast<float>()) ? 1 : 0);
  }
  std::vector<std::uint32_t> repeated;
  for (const std::uint32_t i : keyframe.landmarks) {
    int num_near = 0, num_twins = 0;
    for (std::size_t k = 0; k < keyframe.landmarks.size(); ++k) {
      if ((map.landmarks[keyframe.landmarks[k]].position_m - map.landmarks[i].position_m).squaredNorm() > kNeighbourhoodM * kNeighbourhoodM)
        continue;
      ++num_near;
      num_twins += has_twin[k];
    }
    if (num_twins >= kMinShare * num_near) repeated.push_back(i);
  }
  return repeated;
}

}  // namespace

bool add_look_alikes(const MapView& map, MapData* data, WorkObserver& observer) {
  const TwinFinder twin_finder(*data);
  RivalSearch search(map, *data, {.max_compared = 12, .min_matches = kMinRivalInliers});
  std::vector<map_format::RivalRecord> records;
  std::vector<std::byte> twins(data->landmarks.size(), std::byte{0});
  for (std::uint32_t k = 0; k < data->keyframes.size(); ++k) {
    observer.show("look-alikes, keyframe", k + 1, data->keyframes.size(), std::to_string(records.size()) + " found");
    if (observer.should_stop()) return false;
    std::vector<RivalPlace> places = search.find(k);
    std::erase_if(places, [](const RivalPlace& place) { return place.num_inliers < kMinRivalInliers; });
    std::stable_sort(places.begin(), places.end(), [](const RivalPlace& a, const RivalPlace& b) { return a.num_inliers > b.num_inliers; });
    for (const RivalPlace& place : places) {
      for (const std::uint32_t landmark : repeated_landmarks(*data, twin_finder, data->keyframes[k], place))
        if (twins[landmark] != std::byte{255}) twins[landmark] = std::byte(std::to_integer<int>(twins[landmark]) + 1);
    }
    places.resize(std::min(places.size(), kMaxRivals));
    for (const RivalPlace& place : places)
      records.push_back(pack_rival(k, {place.keyframe, place.T_map_camera}, data->keyframes[place.keyframe].T_map_camera));
  }
  const std::span<const std::byte> bytes = std::as_bytes(std::span(records));
  data->extra_sections[map_format::kRivals] = {true, sizeof(map_format::RivalRecord), {bytes.begin(), bytes.end()}};
  data->extra_sections[map_format::kTwins] = {true, 1, std::move(twins)};
  return true;
}

}  // namespace camloc
