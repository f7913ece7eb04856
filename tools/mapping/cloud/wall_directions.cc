// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "tools/mapping/cloud/cloud_index.h"
#include "tools/mapping/cloud/point_cloud.h"

namespace camloc::mapping {
namespace {

constexpr std::size_t kMaxNormals = 3000, kMaxGuesses = 300;
constexpr double kSameCosine = 0.985;   // 10 degrees
constexpr double kAcrossCosine = 0.17;  // 80 degrees
constexpr int kRefinements = 5;

std::vector<Eigen::Vector3d> normals_of(const std::vector<Eigen::Vector3d>& points_m) {
  const std::vector<Eigen::Vector3f> points = to_float(points_m);
  CloudIndex index(points);
  std::vector<Eigen::Vector3d> normals;
  const std::size_t count = std::min(kMaxNormals, points.size());
  for (std::size_t i = 0; i < count; ++i) {
    const CloudIndex::Plane& plane = index.plane_at(static_cast<std::uint32_t>(i * points.size() / count));
    if (plane.is_flat) normals.push_back(plane.normal);
  }
  return normals;
}

/// The direction that most normals share, made better by their mean; only those across `across`, where it is not zero.
Eigen::Vector3d dominant(const std::vector<Eigen::Vector3d>& normals, const Eigen::Vector3d& across) {
  Eigen::Vector3d best = Eigen::Vector3d::Zero();
  std::size_t best_count = 0;
  const std::size_t step = normals.size() / kMaxGuesses + 1;
  for (std::size_t i = 0; i < normals.size(); i += step) {
    if (std::abs(normals[i].dot(across)) > kAcrossCosine) continue;
    const auto count = static_cast<std::size_t>(
        std::count_if(normals.begin(), normals.end(), [&](const Eigen::Vector3d& n) { return std::abs(n.dot(normals[i])) > kSameCosine; }));
    if (count > best_count) best_count = count, best = normals[i];
  }
  for (int i = 0; i < kRefinements && best_count > 0; ++i) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& n : normals)
      if (std::abs(n.dot(best)) > kSameCosine) sum += n.dot(best) > 0 ? n : Eigen::Vector3d(-n);
    best = sum.normalized();
  }
  return best;
}

Eigen::Matrix3d principal_axes(const std::vector<Eigen::Vector3d>& points_m) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points_m) mean += p / static_cast<double>(points_m.size());
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : points_m) moments += (p - mean) * (p - mean).transpose();
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(moments).eigenvectors();
}

}  // namespace

Eigen::Matrix3d wall_directions(const std::vector<Eigen::Vector3d>& points_m) {
  const std::vector<Eigen::Vector3d> normals = normals_of(points_m);
  Eigen::Matrix3d axes;
  axes.col(0) = dominant(normals, Eigen::Vector3d::Zero());
  axes.col(1) = dominant(normals, axes.col(0));
  if (axes.col(0).norm() < 0.5 || axes.col(1).norm() < 0.5) axes = principal_axes(points_m);
  axes.col(1) = (axes.col(1) - axes.col(0) * axes.col(0).dot(axes.col(1))).normalized();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return axes;
}

}  // namespace camloc::mapping
