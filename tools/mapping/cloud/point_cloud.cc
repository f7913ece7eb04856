// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/mapping/cloud/point_cloud.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/order_statistics.h"

namespace camloc::mapping {
namespace {

constexpr std::size_t kPointsForOrigin = 4096;  // their median: an invalid return at (0, 0, 0) may come first
constexpr std::size_t kCompactAt = std::size_t{1} << 20;
constexpr std::uint64_t kPointsForStep = 100;  // fewer may be round numbers by chance
constexpr double kMaxCells = 1e9;              // from the origin; fits 32 bits
constexpr double kMaxReachM = 1e7;
constexpr std::size_t kMaxPercentileSamples = 200000;

}  // namespace

std::array<Eigen::Vector3d, 2> PointCloud::bounds_m() const {
  return trimmed_bounds(points_m, 200, points_m.size() / kMaxPercentileSamples + 1);
}

std::vector<Eigen::Vector3d> chosen_evenly(std::span<const Eigen::Vector3d> points, std::size_t max_points) {
  std::vector<Eigen::Vector3d> chosen;
  const std::size_t count = std::min(points.size(), max_points);
  for (std::size_t i = 0; i < count; ++i) chosen.push_back(points[i * points.size() / count]);
  return chosen;
}

std::vector<Eigen::Vector3f> to_float(std::span<const Eigen::Vector3d> points) {
  std::vector<Eigen::Vector3f> result;
  result.reserve(points.size());
  for (const Eigen::Vector3d& p : points) result.push_back(p.cast<float>());
  return result;
}

CloudAccumulator::CloudAccumulator(const CloudOptions& options) : options_(options), compact_at_(kCompactAt) {
  cloud_.unit_m = options.unit_m.value_or(1);
  cloud_.unit_from = options.unit_m ? "as given" : "assumed, the file does not say";
}

void CloudAccumulator::declare_unit(double unit_m, const std::string& source) {
  if (takes_declared_unit()) {
    cloud_.unit_m = unit_m;
    cloud_.unit_from = "the file says " + source;
  } else if (std::abs(unit_m / cloud_.unit_m - 1) > 1e-7) {
    warn("UNIT: " + std::to_string(cloud_.unit_m) + " m a unit was asked for, and the file says " + source + "; is the option right?");
  }
}

void CloudAccumulator::add(const Eigen::Vector3d& p) {
  ++cloud_.num_read;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double value = p[static_cast<Eigen::Index>(axis)];
    exceeds_float_[axis] = exceeds_float_[axis] || value != static_cast<double>(static_cast<float>(value));
  }
  const Eigen::Vector3d p_m = cloud_.unit_m * p;
  if (!p_m.allFinite()) {
    ++cloud_.num_invalid;
  } else if (is_started_) {
    store(p_m);
  } else {
    first_points_m_.push_back(p_m);
    if (first_points_m_.size() >= kPointsForOrigin) start();
  }
}

void CloudAccumulator::start() {
  is_started_ = true;
  for (int axis = 0; axis < 3 && !first_points_m_.empty(); ++axis) {
    std::vector<double> values;
    for (const Eigen::Vector3d& p : first_points_m_) values.push_back(p[axis]);
    cloud_.origin_m[axis] = std::floor(upper_median(std::move(values)));
  }
  for (const Eigen::Vector3d& p : first_points_m_) store(p);
  first_points_m_ = {};
}

void CloudAccumulator::store(const Eigen::Vector3d& p_m) {
  const Eigen::Vector3d relative = p_m - cloud_.origin_m;
  const double reach_m = std::min(kMaxReachM, kMaxCells * options_.voxel_m);
  if (!(relative.cwiseAbs().maxCoeff() < reach_m)) {
    ++cloud_.num_invalid;
    return;
  }
  Voxel voxel{{}, 1, {}};
  for (int axis = 0; axis < 3; ++axis) {
    const double cell = std::floor(relative[axis] / options_.voxel_m);
    voxel.cell[static_cast<std::size_t>(axis)] = static_cast<std::int32_t>(cell);
    voxel.sum_m[axis] = static_cast<float>(relative[axis] - cell * options_.voxel_m);
  }
  voxels_.push_back(voxel);
  if (voxels_.size() >= compact_at_) compact();
}

void CloudAccumulator::compact() {
  const auto by_cell = [](const Voxel& a, const Voxel& b) { return a.cell < b.cell; };
  const auto middle = voxels_.begin() + static_cast<std::ptrdiff_t>(num_compact_);
  std::stable_sort(middle, voxels_.end(), by_cell);
  std::inplace_merge(voxels_.begin(), middle, voxels_.end(), by_cell);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < voxels_.size(); ++i) {
    if (kept > 0 && voxels_[kept - 1].cell == voxels_[i].cell) {
      Voxel& into = voxels_[kept - 1];
      into.sum_m += voxels_[i].sum_m;
      into.count += std::min(voxels_[i].count, std::numeric_limits<std::uint32_t>::max() - into.count);
    } else {
      voxels_[kept++] = voxels_[i];
    }
  }
  voxels_.resize(kept);
  num_compact_ = kept;
  compact_at_ = kept + std::max(kCompactAt, kept / 2);
}

Eigen::Vector3d CloudAccumulator::float_steps_m() const {
  Eigen::Vector3d steps_m = Eigen::Vector3d::Zero();
  if (cloud_.num_read - cloud_.num_invalid < kPointsForStep) return steps_m;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const auto value = static_cast<float>(std::abs(cloud_.origin_m[axis] / cloud_.unit_m));
    if (exceeds_float_[static_cast<std::size_t>(axis)] || !(value < std::numeric_limits<float>::max())) continue;
    steps_m[axis] = cloud_.unit_m * static_cast<double>(std::nextafter(value, std::numeric_limits<float>::max()) - value);
  }
  return steps_m;
}

PointCloud CloudAccumulator::finish() {
  if (!is_started_) start();
  compact();
  cloud_.step_m = float_steps_m();
  PointCloud cloud = std::move(cloud_);
  cloud.points_m.reserve(voxels_.size());
  for (const Voxel& voxel : voxels_) {
    if (voxel.count < options_.min_points) continue;
    Eigen::Vector3d p = (voxel.sum_m / static_cast<float>(voxel.count)).cast<double>();
    for (int axis = 0; axis < 3; ++axis) p[axis] += options_.voxel_m * voxel.cell[static_cast<std::size_t>(axis)];
    cloud.points_m.push_back(p.cast<float>());
  }
  *this = CloudAccumulator(options_);
  return cloud;
}

}  // namespace camloc::mapping
