// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/map/map_landmarks.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace camloc {
namespace {

/// Landmarks in view before the most observed are picked: a multiple of what is handed out.
constexpr int kOversampling = 4;

}  // namespace

MapLandmarks::MapLandmarks(const MapView& map, const Intrinsics& color, const MapLandmarksOptions& options, const LookAlikes* look_alikes)
    : map_(&map),
      look_alikes_(look_alikes),
      options_(options),
      projector_(color, PyramidLevels(map.info().orb_scale_factor, static_cast<int>(map.info().orb_num_levels)), options.limits) {
  log_reference_.resize(256);
  for (int code = 0; code < 256; ++code) {
    log_reference_[static_cast<std::size_t>(code)] = std::log(MapView::reference_m(static_cast<std::uint8_t>(code)));
  }
  cubes_.reserve(map.cubes().size());
  const auto capacity = static_cast<std::size_t>(options.max_landmarks) * kOversampling;
  projected_.reserve(capacity);
  num_observations_.reserve(capacity);
}

std::span<const ProjectedLandmark> MapLandmarks::project(const Rigid3& T_map_camera, float radius_px) {
  projected_.clear();
  num_observations_.clear();
  num_visited_ = 0;
  collect_cubes(T_map_camera.inverse());
  projector_.aim(T_map_camera, radius_px);
  for (const NearCube& near : cubes_) project_cube(map_->cubes()[near.index]);
  keep_most_observed();
  return projected_;
}

void MapLandmarks::collect_cubes(const Rigid3& T_camera_map) {
  cubes_.clear();
  const auto cubes = map_->cubes();
  for (std::uint32_t i = 0; i < cubes.size() && cubes_.size() < cubes_.capacity(); ++i) {
    const auto& cube = cubes[i];
    const double half = 0.5 * cube.extent_m;
    const Eigen::Vector3d center_map = Eigen::Vector3d(cube.origin_m[0], cube.origin_m[1], cube.origin_m[2]).array() + half;
    const Eigen::Vector3d center = T_camera_map * center_map;
    const double radius = half * std::sqrt(3.0);
    if (!projector_.may_see(center, radius)) continue;
    cubes_.push_back({static_cast<float>(std::max(0.0, center.norm() - radius)), i});
  }
  const auto count = std::min(cubes_.size(), static_cast<std::size_t>(options_.max_cubes));
  std::partial_sort(
      cubes_.begin(), cubes_.begin() + static_cast<std::ptrdiff_t>(count), cubes_.end(),
      [](const NearCube& a, const NearCube& b) { return a.distance_m != b.distance_m ? a.distance_m < b.distance_m : a.index < b.index; });
  cubes_.resize(count);
}

void MapLandmarks::project_cube(const map_format::CubeRecord& cube) {
  const auto landmarks = map_->landmarks();
  const std::uint32_t first = std::min<std::uint32_t>(cube.first_landmark, static_cast<std::uint32_t>(landmarks.size()));
  const std::uint32_t end = first + std::min<std::uint32_t>(cube.num_landmarks, static_cast<std::uint32_t>(landmarks.size()) - first);
  for (std::uint32_t i = first; i < end && num_visited_ < options_.max_visited && projected_.size() < projected_.capacity(); ++i) {
    ++num_visited_;
    const map_format::LandmarkRecord& landmark = landmarks[i];
    LandmarkProjector::Seen seen;
    if (!projector_.is_in_view(MapView::position_m(cube, landmark), &seen)) continue;
    ProjectedLandmark projected;
    if (!projector_.is_recognizable(seen, MapView::direction(landmark), MapView::view_cosine(landmark),
                                    log_reference_[landmark.min_reference], log_reference_[landmark.max_reference], &projected))
      continue;
    projected.landmark = static_cast<std::int32_t>(i);
    projected_.push_back(projected);
    num_observations_.push_back(landmark.num_observations);
  }
}

void MapLandmarks::keep_most_observed() {
  const auto limit = static_cast<std::size_t>(options_.max_landmarks);
  if (projected_.size() > limit) {
    std::array<std::uint32_t, 256> histogram{};
    for (const std::uint8_t count : num_observations_) ++histogram[count];
    std::size_t kept = 0;
    int threshold = 255;
    while (threshold > 0 && kept + histogram[static_cast<std::size_t>(threshold)] <= limit)
      kept += histogram[static_cast<std::size_t>(threshold--)];
    std::size_t at_threshold = limit - kept;  // of the last class only as many as fit, in map order
    std::size_t out = 0;
    for (std::size_t i = 0; i < projected_.size(); ++i) {
      const bool is_above = num_observations_[i] > threshold;
      const bool is_at = num_observations_[i] == threshold && at_threshold > 0;
      if (!is_above && !is_at) continue;
      if (is_at) --at_threshold;
      projected_[out++] = projected_[i];
    }
    projected_.resize(out);
  }
  for (ProjectedLandmark& landmark : projected_) {
    landmark.first_descriptor = map_->first_descriptor(static_cast<std::uint32_t>(landmark.landmark));
    landmark.num_descriptors = map_->num_descriptors(static_cast<std::uint32_t>(landmark.landmark));
  }
}

}  // namespace camloc
