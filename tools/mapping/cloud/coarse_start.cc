// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Where a map lies in a cloud when nobody says it; declared in cloud_registration.h. Buildings have walls in three directions:
// the map's are laid onto the cloud's in all 24 ways, and for each the translation is found by sliding the map's cells over the
// cloud's, which works where the map holds only a part of the scan. The best places are improved by closest points.
#include <algorithm>
#include <utility>

#include "core/geometry/alignment.h"
#include "tools/mapping/cloud/cloud_index.h"
#include "tools/mapping/cloud/cloud_registration.h"
#include "tools/mapping/cloud/point_cloud.h"

namespace camloc::mapping {
namespace {

constexpr double kCellM = 0.25;  // surfaces count by area, not by how often they were scanned
constexpr std::size_t kNumSamples = 800;
constexpr std::size_t kMaxCells = 300000;  // of the grid in which the map is slid; larger sites get larger cells
constexpr std::size_t kNumImproved = 30, kNumKept = 6;
constexpr double kTrim = 0.75;
constexpr double kFarM = 3;  // what is farther counts as this far
constexpr int kIterations = 12;
constexpr double kSamePlaceM = 0.5, kSamePlaceRad = 0.17;

std::vector<Eigen::Vector3d> absolute(const PointCloud& cloud) {
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector3f& p : cloud.points_m) points.push_back(cloud.origin_m + p.cast<double>());
  return points;
}

/// The 24 rotations that map a cube onto itself.
std::vector<Eigen::Matrix3d> cube_rotations() {
  std::vector<Eigen::Matrix3d> rotations;
  const int permutations[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {1, 0, 2}, {0, 2, 1}, {2, 1, 0}};
  for (const auto& permutation : permutations) {
    for (int signs = 0; signs < 8; ++signs) {
      Eigen::Matrix3d rotation = Eigen::Matrix3d::Zero();
      for (int row = 0; row < 3; ++row) rotation(row, permutation[row]) = (signs >> row & 1) != 0 ? -1 : 1;
      if (rotation.determinant() > 0) rotations.push_back(rotation);
    }
  }
  return rotations;
}

bool is_same_place(const Rigid3& a, const Rigid3& b, const Eigen::Vector3d& center_map) {
  return (a * center_map - b * center_map).norm() < kSamePlaceM && rotation_distance_rad(a.rotation, b.rotation) < kSamePlaceRad;
}

/// The closest pairs, and the mean distance of the closest samples.
double match(const std::vector<Eigen::Vector3d>& samples, const CloudIndex& cloud, const Rigid3& T_cloud_map,
             std::vector<PointPair>* pairs) {
  std::vector<std::pair<double, PointPair>> found;
  for (const Eigen::Vector3d& p_map : samples) {
    const auto neighbor = cloud.nearest(T_cloud_map * p_map, kFarM);
    if (neighbor) found.push_back({neighbor->distance_m, {cloud.points_m()[neighbor->index].cast<double>(), p_map}});
  }
  const auto num_wanted = static_cast<std::size_t>(kTrim * static_cast<double>(samples.size())),
             num_kept = std::min(num_wanted, found.size());
  std::nth_element(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(num_kept), found.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  double sum = kFarM * static_cast<double>(num_wanted - num_kept);
  pairs->clear();
  for (std::size_t i = 0; i < num_kept; ++i) {
    sum += found[i].first;
    pairs->push_back(found[i].second);
  }
  return sum / static_cast<double>(std::max<std::size_t>(1, num_wanted));
}

/// Iterative closest points, point to point: slow at the end, but it comes from far.
void improve(const std::vector<Eigen::Vector3d>& samples, const CloudIndex& cloud, CoarseStart* candidate) {
  std::vector<PointPair> pairs;
  candidate->score_m = match(samples, cloud, candidate->T_cloud_map, &pairs);
  for (int i = 0; i < kIterations && !pairs.empty(); ++i) {
    const Rigid3 aligned = align_rigid(pairs).T_a_b;
    const double score = match(samples, cloud, aligned, &pairs);
    if (score >= candidate->score_m) return;
    const bool is_still = score > 0.998 * candidate->score_m;
    *candidate = {aligned, score};
    if (is_still) return;
  }
}

/// The map's walls on the cloud's in all ways, each at the places where most cells meet; their share stands for the score.
std::vector<CoarseStart> slide(const std::vector<Eigen::Vector3d>& samples, const std::vector<Eigen::Vector3d>& map_cells,
                               const std::vector<Eigen::Vector3d>& cloud_cells) {
  const Eigen::Matrix3d map_axes = wall_directions(map_cells), cloud_axes = wall_directions(cloud_cells);
  // The grid stands along the walls, so that a wall is one layer of cells.
  std::vector<Eigen::Vector3d> turned;
  for (const Eigen::Vector3d& p : cloud_cells) turned.push_back(cloud_axes.transpose() * p);
  const CellGrid grid(turned, kCellM, kMaxCells);
  std::vector<CoarseStart> candidates;
  for (const Eigen::Matrix3d& cube : cube_rotations()) {
    const Eigen::Matrix3d R_grid_map = cube * map_axes.transpose();
    std::vector<Eigen::Vector3d> points;
    for (const Eigen::Vector3d& p : samples) points.push_back(R_grid_map * p);
    for (const CellGrid::Place& place : grid.best_places(points, 5)) {
      candidates.push_back(
          {{Eigen::Quaterniond(Eigen::Matrix3d(cloud_axes * R_grid_map)).normalized(), cloud_axes * place.translation_m}, place.share});
    }
  }
  std::sort(candidates.begin(), candidates.end(), [](const CoarseStart& a, const CoarseStart& b) { return a.score_m > b.score_m; });
  candidates.resize(std::min(candidates.size(), kNumImproved));
  return candidates;
}

}  // namespace

Result<std::vector<CoarseStart>> find_coarse_starts(std::span<const Eigen::Vector3d> points_map, std::span<const Eigen::Vector3f> cloud_m,
                                                    const Eigen::Vector3d& cloud_origin_m) {
  const std::vector<Eigen::Vector3d> cloud_cells = absolute(thinned(cloud_m, kCellM / 2)),
                                     map_cells = absolute(thinned(points_map, kCellM / 2));
  if (map_cells.size() < 20 || cloud_cells.size() < 20) {
    return {ErrorCode::kInvalid, "map or cloud is smaller than a metre, too small to find a start; give control points (--points)"};
  }
  const std::vector<Eigen::Vector3d> samples = chosen_evenly(absolute(thinned(map_cells, kCellM)), kNumSamples);
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : samples) center += p / static_cast<double>(samples.size());

  const Rigid3 identity{Eigen::Quaterniond::Identity(), -cloud_origin_m};
  std::vector<CoarseStart> candidates = slide(samples, map_cells, cloud_cells);
  candidates.push_back({identity, 0});
  const std::vector<Eigen::Vector3f> targets = to_float(cloud_cells);
  const CloudIndex index(targets);
  for (CoarseStart& candidate : candidates) improve(samples, index, &candidate);
  std::stable_sort(candidates.begin(), candidates.end(), [](const CoarseStart& a, const CoarseStart& b) { return a.score_m < b.score_m; });

  std::vector<CoarseStart> starts;
  for (const CoarseStart& candidate : candidates) {
    const auto is_known = [&](const CoarseStart& start) { return is_same_place(start.T_cloud_map, candidate.T_cloud_map, center); };
    if (starts.size() >= kNumKept || std::any_of(starts.begin(), starts.end(), is_known)) continue;
    // The map's own frame as it is, so that the report can say how far off it was.
    const bool is_identity = is_same_place(identity, candidate.T_cloud_map, center);
    starts.push_back({is_identity ? identity : candidate.T_cloud_map, candidate.score_m, is_identity});
  }
  return starts;
}

}  // namespace camloc::mapping
