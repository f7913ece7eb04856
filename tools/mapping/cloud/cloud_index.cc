// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/mapping/cloud/cloud_index.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nanoflann.hpp>
#include <unordered_map>

namespace camloc::mapping {
namespace {

constexpr float kPlaneRadiusM = 0.08F;
constexpr std::size_t kMinPlanePoints = 12;
constexpr std::size_t kMaxPlanePoints = 256;  // a plane is known well enough then

struct Adaptor {
  std::span<const Eigen::Vector3f> points;
  [[nodiscard]] std::size_t kdtree_get_point_count() const { return points.size(); }
  [[nodiscard]] float kdtree_get_pt(std::uint32_t index, std::size_t axis) const { return points[index][static_cast<Eigen::Index>(axis)]; }
  template <typename Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Adaptor>, Adaptor, 3, std::uint32_t>;

CloudIndex::Plane fit_plane(std::span<const Eigen::Vector3f> points, std::span<const std::uint32_t> neighbors, std::uint32_t center) {
  const Eigen::Vector3d origin = points[center].cast<double>();
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (const std::uint32_t i : neighbors) {
    const Eigen::Vector3d d = points[i].cast<double>() - origin;
    mean += d;
    moments += d * d.transpose();
  }
  const double count = std::max<double>(1, static_cast<double>(neighbors.size()));
  mean /= count;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(moments / count - mean * mean.transpose());
  CloudIndex::Plane plane;
  plane.normal = solver.eigenvectors().col(0).normalized();
  if (!plane.normal.allFinite()) plane.normal = Eigen::Vector3d::UnitZ();
  plane.is_flat =
      neighbors.size() >= 5 && std::sqrt(std::max(0.0, solver.eigenvalues()[0])) < 0.33 * std::sqrt(std::max(0.0, solver.eigenvalues()[1]));
  plane.point_m = plane.is_flat ? Eigen::Vector3d(origin + mean) : origin;
  return plane;
}

}  // namespace

struct CloudIndex::Impl {
  explicit Impl(std::span<const Eigen::Vector3f> points)
      : adaptor{points}, tree(3, adaptor, nanoflann::KDTreeSingleIndexAdaptorParams(16)) {}
  Adaptor adaptor;
  Tree tree;
  std::unordered_map<std::uint32_t, Plane> planes;
  std::vector<std::pair<std::uint32_t, float>> in_radius;
  std::vector<std::uint32_t> neighbors;
};

CloudIndex::CloudIndex(std::span<const Eigen::Vector3f> points_m) : impl_(std::make_unique<Impl>(points_m)) {}
CloudIndex::~CloudIndex() = default;

std::span<const Eigen::Vector3f> CloudIndex::points_m() const { return impl_->adaptor.points; }

std::optional<CloudIndex::Neighbor> CloudIndex::nearest(const Eigen::Vector3d& p_m, double max_distance_m) const {
  if (impl_->adaptor.points.empty() || !p_m.allFinite()) return std::nullopt;
  const Eigen::Vector3f query = p_m.cast<float>();
  std::uint32_t index = 0;
  float squared_m2 = 0;
  nanoflann::KNNResultSet<float, std::uint32_t> result(1);
  result.init(&index, &squared_m2);
  // An upper bound from the start cuts the search short far from the cloud.
  squared_m2 = static_cast<float>(std::min<double>(max_distance_m * max_distance_m, std::numeric_limits<float>::max()));
  impl_->tree.findNeighbors(result, query.data(), nanoflann::SearchParams());
  if (result.size() == 0) return std::nullopt;
  return Neighbor{index, (p_m - impl_->adaptor.points[index].cast<double>()).norm()};
}

const CloudIndex::Plane& CloudIndex::plane_at(std::uint32_t index) {
  const auto known = impl_->planes.find(index);
  if (known != impl_->planes.end()) return known->second;
  const Eigen::Vector3f& point = impl_->adaptor.points[index];
  impl_->tree.radiusSearch(point.data(), kPlaneRadiusM * kPlaneRadiusM, impl_->in_radius, nanoflann::SearchParams(32, 0, false));
  auto& neighbors = impl_->neighbors;
  neighbors.clear();
  if (impl_->in_radius.size() >= kMinPlanePoints) {
    const std::size_t step = impl_->in_radius.size() / kMaxPlanePoints + 1;
    for (std::size_t i = 0; i < impl_->in_radius.size(); i += step) neighbors.push_back(impl_->in_radius[i].first);
  } else {
    std::array<float, kMinPlanePoints> ignored;
    neighbors.resize(kMinPlanePoints);
    neighbors.resize(impl_->tree.knnSearch(point.data(), kMinPlanePoints, neighbors.data(), ignored.data()));
  }
  return impl_->planes.emplace(index, fit_plane(impl_->adaptor.points, neighbors, index)).first->second;
}

}  // namespace camloc::mapping
