// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/localize/local_landmarks.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace camloc {
namespace {

constexpr float kMinDepth = 0.2F;
/// Landmarks in view before the most observed are picked: a multiple of what is handed out.
constexpr int kOversampling = 4;

}  // namespace

LocalLandmarks::LocalLandmarks(const MapView& map, const Intrinsics& color, const LocalLandmarksOptions& options)
    : map_(&map), color_(color), options_(options), inverse_log_scale_(1.0F / std::log(map.info().orb_scale_factor)) {
  log_reference_.resize(256);
  for (int code = 0; code < 256; ++code) {
    log_reference_[static_cast<std::size_t>(code)] = std::log(MapView::reference_m(static_cast<std::uint8_t>(code)));
  }
  cubes_.reserve(map.cubes().size());
  const auto capacity = static_cast<std::size_t>(options.max_landmarks) * kOversampling;
  projected_.reserve(capacity);
  num_observations_.reserve(capacity);
}

std::span<const ProjectedLandmark> LocalLandmarks::project(const Rigid3& T_map_camera, float radius_px) {
  projected_.clear();
  num_observations_.clear();
  num_visited_ = 0;
  collect_cubes(T_map_camera.inverse());
  for (const NearCube& near : cubes_) project_cube(map_->cubes()[near.index], T_map_camera, radius_px);
  keep_most_observed();
  return projected_;
}

void LocalLandmarks::collect_cubes(const Rigid3& T_camera_map) {
  cubes_.clear();
  const auto cubes = map_->cubes();
  for (std::uint32_t i = 0; i < cubes.size() && cubes_.size() < cubes_.capacity(); ++i) {
    const auto& cube = cubes[i];
    const double half = 0.5 * cube.extent_m;
    const Eigen::Vector3d center_map = Eigen::Vector3d(cube.origin_m[0], cube.origin_m[1], cube.origin_m[2]).array() + half;
    const Eigen::Vector3d center = T_camera_map * center_map;
    const double radius = half * std::sqrt(3.0);
    if (center.z() < -radius || center.norm() > options_.max_range_m + radius) continue;
    cubes_.push_back({static_cast<float>(std::max(0.0, center.norm() - radius)), i});
  }
  const auto count = std::min(cubes_.size(), static_cast<std::size_t>(options_.max_cubes));
  std::partial_sort(
      cubes_.begin(), cubes_.begin() + static_cast<std::ptrdiff_t>(count), cubes_.end(),
      [](const NearCube& a, const NearCube& b) { return a.distance_m != b.distance_m ? a.distance_m < b.distance_m : a.index < b.index; });
  cubes_.resize(count);
}

void LocalLandmarks::project_cube(const map_format::CubeRecord& cube, const Rigid3& T_map_camera, float radius_px) {
  const auto landmarks = map_->landmarks();
  const std::uint32_t first = std::min<std::uint32_t>(cube.first_landmark, static_cast<std::uint32_t>(landmarks.size()));
  const std::uint32_t end = first + std::min<std::uint32_t>(cube.num_landmarks, static_cast<std::uint32_t>(landmarks.size()) - first);

  const Eigen::Matrix3f R_camera_map = T_map_camera.rotation.conjugate().toRotationMatrix().cast<float>();
  const Eigen::Vector3f camera_center = T_map_camera.translation.cast<float>();
  const auto margin = static_cast<float>(options_.view_angle_margin_rad);
  const float cos_margin = std::cos(margin);
  const float sin_margin = std::sin(margin);
  const int max_level = static_cast<int>(map_->info().orb_num_levels) - 1;

  for (std::uint32_t i = first; i < end && num_visited_ < options_.max_visited && projected_.size() < projected_.capacity(); ++i) {
    ++num_visited_;
    const auto& landmark = landmarks[i];
    const Eigen::Vector3f to_landmark = MapView::position_m(cube, landmark) - camera_center;
    const Eigen::Vector3f p_camera = R_camera_map * to_landmark;
    if (p_camera.z() < kMinDepth || p_camera.z() > static_cast<float>(options_.max_range_m)) continue;
    const float x = p_camera.x() / p_camera.z();
    const float y = p_camera.y() / p_camera.z();
    if (std::abs(x) > 2.0F || std::abs(y) > 2.0F) continue;
    const Eigen::Vector2d pixel = color_.distort({x, y});
    if (pixel.x() < 0 || pixel.y() < 0 || pixel.x() > color_.width - 1 || pixel.y() > color_.height - 1) continue;

    // Seen from beyond the widest mapped angle plus a margin? cos(a + m) = cos a cos m - sin a sin m.
    const float distance = to_landmark.norm();
    const float cosine = -to_landmark.dot(MapView::direction(landmark)) / distance;
    const float widest = MapView::view_cosine(landmark);
    const float limit = widest * cos_margin - std::sqrt(std::max(0.0F, 1.0F - widest * widest)) * sin_margin;
    if (cosine < limit) continue;

    const float log_distance = std::log(distance);
    const int lowest =
        static_cast<int>(std::floor((log_reference_[landmark.min_reference] - log_distance) * inverse_log_scale_)) - options_.level_margin;
    const int highest =
        static_cast<int>(std::ceil((log_reference_[landmark.max_reference] - log_distance) * inverse_log_scale_)) + options_.level_margin;
    if (highest < 0 || lowest > max_level) continue;

    ProjectedLandmark& out = projected_.emplace_back();
    out.landmark = static_cast<std::int32_t>(i);
    out.u = static_cast<float>(pixel.x());
    out.v = static_cast<float>(pixel.y());
    out.radius_px = radius_px;
    out.min_level = static_cast<std::uint8_t>(std::max(lowest, 0));
    out.max_level = static_cast<std::uint8_t>(std::min(highest, max_level));
    num_observations_.push_back(landmark.num_observations);
  }
}

void LocalLandmarks::keep_most_observed() {
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
