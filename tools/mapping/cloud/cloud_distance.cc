// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/order_statistics.h"
#include "tools/mapping/cloud/cloud_registration.h"
#include "tools/mapping/cloud/point_cloud.h"

namespace camloc::mapping {
namespace {

constexpr double kCellM = 0.25;     // edge of the cells in which coverage is counted
constexpr double kCoveredM = 0.25;  // a cell is covered when a landmark is this close to it
constexpr double kViewRangeM = 5;   // only what is this close to a keyframe can be expected in the map

void measure_landmarks(std::span<const Eigen::Vector3d> landmarks_m, CloudIndex* cloud, double max_distance_m, CloudDistances* result) {
  std::vector<float> near_m, plane_m;
  for (const Eigen::Vector3d& p : landmarks_m) {
    const auto neighbor = cloud->nearest(p, std::numeric_limits<double>::max());
    if (!neighbor) continue;  // an empty cloud
    result->point_m.push_back(static_cast<float>(neighbor->distance_m));
    if (neighbor->distance_m > max_distance_m) {
      ++result->num_outside;
      continue;
    }
    const CloudIndex::Plane& plane = cloud->plane_at(neighbor->index);
    near_m.push_back(static_cast<float>(neighbor->distance_m));
    // Beside an edge of the scan, and where there is no plane, the point itself is the surface.
    const double to_plane_m = std::abs(plane.normal.dot(p - plane.point_m));
    plane_m.push_back(plane.is_flat ? static_cast<float>(std::min(to_plane_m, neighbor->distance_m)) : near_m.back());
  }
  result->point = statistics_of(near_m);
  result->plane = statistics_of(plane_m);
  result->all = statistics_of(result->point_m);
}

void measure_coverage(std::span<const Eigen::Vector3d> landmarks_m, std::span<const Eigen::Vector3d> keyframes_m, const CloudIndex& cloud,
                      const std::array<Eigen::Vector3d, 2>& map_box, CloudDistances* result) {
  const PointCloud cells = thinned(cloud.points_m(), kCellM);
  const std::vector<Eigen::Vector3f> landmarks = to_float(landmarks_m), keyframes = to_float(keyframes_m);
  const CloudIndex landmark_index(landmarks), keyframe_index(keyframes);
  std::vector<float> distances_m;
  for (const Eigen::Vector3f& cell : cells.points_m) {
    const Eigen::Vector3d p = cells.origin_m + cell.cast<double>();
    if (((p - map_box[0]).array() < -kCoveredM).any() || ((map_box[1] - p).array() < -kCoveredM).any()) continue;
    if (!keyframes.empty() && !keyframe_index.nearest(p, kViewRangeM)) continue;
    const auto neighbor = landmark_index.nearest(p, std::numeric_limits<double>::max());
    if (neighbor) distances_m.push_back(static_cast<float>(neighbor->distance_m));
  }
  result->cells = statistics_of(distances_m);
  result->num_cells = distances_m.size();
  result->num_covered = static_cast<std::uint64_t>(
      std::count_if(distances_m.begin(), distances_m.end(), [&](float d) { return static_cast<double>(d) <= kCoveredM; }));
}

}  // namespace

DistanceStatistics statistics_of(std::span<const float> values_m) {
  DistanceStatistics result;
  result.count = values_m.size();
  if (values_m.empty()) return result;
  std::vector<float> sorted(values_m.begin(), values_m.end());
  std::sort(sorted.begin(), sorted.end());
  double sum = 0, sum_squares = 0, num_3cm = 0, num_5cm = 0;
  for (const float value : sorted) {
    const double d = static_cast<double>(value);
    sum += d;
    sum_squares += d * d;
    num_3cm += d <= 0.03;
    num_5cm += d <= 0.05;
  }
  const double count = static_cast<double>(sorted.size());
  const auto percentile = [&](double share) { return static_cast<double>(sorted[static_cast<std::size_t>(share * (count - 1) + 0.5)]); };
  result.mean_m = sum / count;
  result.rms_m = std::sqrt(sum_squares / count);
  result.median_m = percentile(0.5);
  result.p95_m = percentile(0.95);
  result.max_m = static_cast<double>(sorted.back());
  result.share_3cm = num_3cm / count;
  result.share_5cm = num_5cm / count;
  return result;
}

double CloudDistances::volume_ratio() const {
  constexpr double kMinSideM = 0.01;
  return map_extent_m.cwiseMax(kMinSideM).prod() / cloud_extent_m.cwiseMax(kMinSideM).prod();
}

CloudDistances measure_distances(std::span<const Eigen::Vector3d> landmarks_m, std::span<const Eigen::Vector3d> keyframes_m,
                                 CloudIndex* cloud, double max_distance_m) {
  CloudDistances result;
  measure_landmarks(landmarks_m, cloud, max_distance_m, &result);
  const auto map_box = trimmed_bounds(landmarks_m, 100), cloud_box = trimmed_bounds(cloud->points_m(), 100);
  result.map_extent_m = map_box[1] - map_box[0];
  result.cloud_extent_m = cloud_box[1] - cloud_box[0];
  measure_coverage(landmarks_m, keyframes_m, *cloud, map_box, &result);
  return result;
}

}  // namespace camloc::mapping
