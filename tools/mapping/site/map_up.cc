// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/mapping/site/map_up.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <optional>

#include "core/base/order_statistics.h"
#include "tools/common/map_points.h"

namespace camloc::mapping {
namespace {

double extent_along(int axis, const std::vector<Eigen::Vector3d>& landmarks, const MapView& map) {
  std::vector<double> values;
  for (const Eigen::Vector3d& p : landmarks) values.push_back(p[axis]);
  auto [low, high] = trimmed_range(std::move(values), 100);
  for (std::uint32_t k = 0; k < map.keyframes().size(); ++k) {
    const double value = map.keyframe_pose(k).translation[axis];
    low = std::min(low, value);
    high = std::max(high, value);
  }
  return high - low;
}

Eigen::Vector3d flattest_axis(const MapView& map) {
  const std::vector<Eigen::Vector3d> landmarks = tools::landmark_positions(map);
  const Eigen::Vector3d extents(extent_along(0, landmarks, map), extent_along(1, landmarks, map), extent_along(2, landmarks, map));
  Eigen::Index flat = 0;
  extents.minCoeff(&flat);
  return Eigen::Vector3d::Unit(flat);
}

/// The direction across all horizontal image axes, up to its sign; nothing where they do not tell.
std::optional<Eigen::Vector3d> upright_axis(const MapView& map) {
  constexpr double kMaxRoll = 0.02, kMinTurn = 0.03;  // mean squared cosines: 8 degrees of roll, 10 degrees of turning
  constexpr double kMinTurnToRoll = 5;
  constexpr double kSnapCosine = 0.9962;
  const auto count = static_cast<std::uint32_t>(map.keyframes().size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (std::uint32_t k = 0; k < count; ++k) {
    const Eigen::Vector3d right = map.keyframe_pose(k).rotation * Eigen::Vector3d::UnitX();
    scatter += right * right.transpose() / count;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);
  const double roll = solver.eigenvalues()[0], turn = solver.eigenvalues()[1];
  if (roll > kMaxRoll || turn < kMinTurn || turn < kMinTurnToRoll * roll) return std::nullopt;
  const Eigen::Vector3d axis = solver.eigenvectors().col(0);
  Eigen::Index main = 0;
  return axis.cwiseAbs().maxCoeff(&main) > kSnapCosine ? Eigen::Vector3d(Eigen::Vector3d::Unit(main)) : axis;
}

}  // namespace

Eigen::Vector3d up_axis(const MapView& map) {
  if (map.info().wcs) return map.info().wcs->T_wcs_map.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d axis = upright_axis(map).value_or(flattest_axis(map));
  double image_top = 0;
  for (std::uint32_t k = 0; k < map.keyframes().size(); ++k)
    image_top -= (map.keyframe_pose(k).rotation * Eigen::Vector3d::UnitY()).dot(axis);
  return image_top < 0 ? Eigen::Vector3d(-axis) : axis;
}

}  // namespace camloc::mapping
