// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Where a map lies in a cloud when nobody says it; declared in cloud_registration.h.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/geometry/alignment.h"
#include "tools/camloc-map/cloud_registration.h"
#include "tools/camloc-map/point_cloud.h"

namespace camloc::map_tool {
namespace {

constexpr double kCellM = 0.25;            // surfaces count by area, not by how often they were scanned
constexpr std::size_t kNumSamples = 600;
constexpr double kTrim = 0.75;
constexpr int kIterations = 40;
constexpr double kSamePlaceM = 0.5, kSamePlaceRad = 0.17;

struct Shape {
  Eigen::Vector3d center, middle;   ///< mean, and the middle of the bounding box along the axes
  Eigen::Matrix3d axes;             ///< columns, by falling extent, right-handed
};

PointCloud thinned(std::span<const Eigen::Vector3d> points, double cell_m) {
  CloudAccumulator accumulator({cell_m, 1, 1});
  for (const Eigen::Vector3d& p : points) accumulator.add(p);
  return accumulator.finish();
}

std::vector<Eigen::Vector3d> absolute(const PointCloud& cloud) {
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector3f& p : cloud.points_m) points.push_back(cloud.origin_m + p.cast<double>());
  return points;
}

Shape shape_of(const std::vector<Eigen::Vector3d>& points) {
  Shape shape;
  shape.center.setZero();
  for (const Eigen::Vector3d& p : points) shape.center += p / static_cast<double>(points.size());
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : points) moments += (p - shape.center) * (p - shape.center).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moments);
  shape.axes = solver.eigenvectors().rowwise().reverse();
  if (shape.axes.determinant() < 0) shape.axes.col(2) *= -1;
  shape.middle = shape.center;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> along;
    for (const Eigen::Vector3d& p : points) along.push_back(shape.axes.col(axis).dot(p - shape.center));
    std::sort(along.begin(), along.end());
    const std::size_t low = along.size() / 50;
    shape.middle += 0.5 * (along[low] + along[along.size() - 1 - low]) * shape.axes.col(axis);
  }
  return shape;
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

struct Candidate {
  Rigid3 T_cloud_map;
  double score_m = 0;
  bool is_identity = false;
};

struct Matched {
  Eigen::Vector3d p_cloud, p_map;
  double distance_m;
};

/// The closest pairs, and their mean distance.
double match(const std::vector<Eigen::Vector3d>& samples, const CloudIndex& cloud, const Rigid3& T_cloud_map, std::vector<Matched>* pairs) {
  pairs->clear();
  for (const Eigen::Vector3d& p_map : samples) {
    const auto neighbor = cloud.nearest(T_cloud_map * p_map, 1e6);
    if (neighbor) pairs->push_back({cloud.points_m()[neighbor->index].cast<double>(), p_map, neighbor->distance_m});
  }
  const auto num_kept = std::max<std::size_t>(1, static_cast<std::size_t>(kTrim * static_cast<double>(pairs->size())));
  std::nth_element(pairs->begin(), pairs->begin() + static_cast<std::ptrdiff_t>(num_kept - 1), pairs->end(),
                   [](const Matched& a, const Matched& b) { return a.distance_m < b.distance_m; });
  pairs->resize(num_kept);
  double sum = 0;
  for (const Matched& pair : *pairs) sum += pair.distance_m;
  return sum / static_cast<double>(num_kept);
}

/// Iterative closest points, point to point: slow at the end, but it comes from far.
void improve(const std::vector<Eigen::Vector3d>& samples, const CloudIndex& cloud, Candidate* candidate) {
  std::vector<Matched> pairs;
  std::vector<camloc::PointPair> points;
  candidate->score_m = match(samples, cloud, candidate->T_cloud_map, &pairs);
  for (int i = 0; i < kIterations; ++i) {
    points.clear();
    for (const Matched& pair : pairs) points.push_back({pair.p_cloud, pair.p_map});
    const Rigid3 aligned = align_rigid(points).T_a_b;
    const double score_m = match(samples, cloud, aligned, &pairs);
    if (score_m >= candidate->score_m) return;
    const bool is_still = score_m > 0.999 * candidate->score_m;
    candidate->T_cloud_map = aligned;
    candidate->score_m = score_m;
    if (is_still) return;
  }
}

std::vector<Candidate> candidates_of(const Shape& map, const Shape& cloud, const Eigen::Vector3d& cloud_origin_m) {
  std::vector<Candidate> candidates;
  candidates.push_back({Rigid3{Eigen::Quaterniond::Identity(), -cloud_origin_m}, 0, true});
  for (const Eigen::Matrix3d& turn : cube_rotations()) {
    for (const bool by_center : {true, false}) {
      Rigid3 T_cloud_map;
      T_cloud_map.rotation = Eigen::Quaterniond(Eigen::Matrix3d(cloud.axes * turn * map.axes.transpose())).normalized();
      T_cloud_map.translation = by_center ? cloud.center - T_cloud_map.rotation * map.center : cloud.middle - T_cloud_map.rotation * map.middle;
      candidates.push_back({T_cloud_map, 0, false});
    }
  }
  return candidates;
}

}  // namespace

Result<CoarseStart> find_coarse_start(std::span<const Eigen::Vector3d> points_map, std::span<const Eigen::Vector3f> cloud_m,
                                      const Eigen::Vector3d& cloud_origin_m) {
  std::vector<Eigen::Vector3d> cloud_points;
  for (const Eigen::Vector3f& p : cloud_m) cloud_points.push_back(p.cast<double>());
  const std::vector<Eigen::Vector3d> cloud_cells = absolute(thinned(cloud_points, kCellM)), map_cells = absolute(thinned(points_map, kCellM));
  if (map_cells.size() < 4 || cloud_cells.size() < 4) {
    return {ErrorCode::kInvalid, "map or cloud is smaller than a metre, too small to find a start; give control points (--points)"};
  }
  std::vector<Eigen::Vector3d> samples;
  for (std::size_t i = 0; i < std::min(kNumSamples, map_cells.size()); ++i) samples.push_back(map_cells[i * map_cells.size() / std::min(kNumSamples, map_cells.size())]);
  const PointCloud coarse = thinned(cloud_points, kCellM / 2);
  std::vector<Eigen::Vector3f> coarse_m;
  for (const Eigen::Vector3d& p : absolute(coarse)) coarse_m.push_back(p.cast<float>());
  const CloudIndex index(coarse_m);
  std::vector<Candidate> candidates = candidates_of(shape_of(map_cells), shape_of(cloud_cells), cloud_origin_m);
  for (Candidate& candidate : candidates) improve(samples, index, &candidate);
  const auto best = std::min_element(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) { return a.score_m < b.score_m; });
  CoarseStart start{best->T_cloud_map, best->score_m, 1e9, best->is_identity};
  // So that the report can say how far the map lies from where its own frame puts it.
  const Rigid3 identity{Eigen::Quaterniond::Identity(), -cloud_origin_m};
  const Eigen::Vector3d center = shape_of(map_cells).center;
  for (const Candidate& other : candidates) {
    const bool is_elsewhere = (other.T_cloud_map * center - start.T_cloud_map * center).norm() > kSamePlaceM ||
                              rotation_distance_rad(other.T_cloud_map.rotation, start.T_cloud_map.rotation) > kSamePlaceRad;
    if (is_elsewhere) start.rival_score_m = std::min(start.rival_score_m, other.score_m);
  }
  const bool is_near = (identity * center - start.T_cloud_map * center).norm() < kSamePlaceM &&
                       rotation_distance_rad(identity.rotation, start.T_cloud_map.rotation) < kSamePlaceRad;
  if (is_near) start.T_cloud_map = identity;
  start.is_identity = is_near;
  return start;
}

}  // namespace camloc::map_tool
