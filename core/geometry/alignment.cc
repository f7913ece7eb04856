// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Everything is done about the two centroids, so that large coordinates lose nothing, and turns are uncorrelated with the
// position of the centroid.
#include "core/geometry/alignment.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/geometry/symmetric_system.h"

namespace camloc {
namespace {

/// Spread across the line over spread along it, below which points are collinear: far above rounding, far below any survey.
constexpr double kMinRelativeSpread = 1e-6;
constexpr double kUnknownPositionM = 1e6;

/// Weighted moments of the pairs about their centroids.
struct Moments {
  double weight = 0;
  Eigen::Vector3d centroid_a = Eigen::Vector3d::Zero(), centroid_b = Eigen::Vector3d::Zero();
  Eigen::Matrix3d cross = Eigen::Matrix3d::Zero();      ///< sum w a b^T
  Eigen::Matrix3d scatter_b = Eigen::Matrix3d::Zero();  ///< sum w b b^T
};

Moments moments_of(std::span<const PointPair> pairs) {
  Moments m;
  if (pairs.empty()) return m;
  const Eigen::Vector3d origin_a = pairs[0].p_a, origin_b = pairs[0].p_b;
  Eigen::Vector3d sum_a = Eigen::Vector3d::Zero(), sum_b = Eigen::Vector3d::Zero();
  for (const PointPair& pair : pairs) {
    const double w = 1 / (pair.sigma_m * pair.sigma_m);
    m.weight += w;
    sum_a += w * (pair.p_a - origin_a);
    sum_b += w * (pair.p_b - origin_b);
  }
  m.centroid_a = origin_a + sum_a / m.weight;
  m.centroid_b = origin_b + sum_b / m.weight;
  for (const PointPair& pair : pairs) {
    const double w = 1 / (pair.sigma_m * pair.sigma_m);
    const Eigen::Vector3d a = pair.p_a - m.centroid_a, b = pair.p_b - m.centroid_b;
    m.cross += w * a * b.transpose();
    m.scatter_b += w * b * b.transpose();
  }
  return m;
}

/// Rotation and rank from the singular values of the cross moments; the similarity's scale when `is_scale_free`.
void solve_rotation_and_scale(const Moments& m, bool is_scale_free, Alignment* alignment) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m.cross, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d spread = svd.singularValues();
  const double coordinates = m.centroid_a.norm() + m.centroid_b.norm();
  const double rounding = 1e-15 * coordinates;  // what a difference of two coordinates may be off by
  if (spread[0] <= m.weight * rounding * rounding || m.scatter_b.trace() <= 0) {
    alignment->rank = AlignmentRank::kPosition;
    return;
  }
  Eigen::Vector3d signs = Eigen::Vector3d::Ones();
  if (spread[1] <= kMinRelativeSpread * kMinRelativeSpread * spread[0]) {
    alignment->rank = AlignmentRank::kLine;
    alignment->free_axis = svd.matrixU().col(0);
    const Eigen::Vector3d axis_b = svd.matrixV().col(0);
    alignment->T_a_b.rotation = shortest_turn(axis_b, alignment->free_axis);
  } else {
    alignment->rank = AlignmentRank::kFull;
    if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0) signs.z() = -1;
    const Eigen::Matrix3d R_a_b = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
    alignment->T_a_b.rotation = Eigen::Quaterniond(R_a_b).normalized();
  }
  if (is_scale_free) alignment->scale = std::max(0.0, spread.dot(signs)) / m.scatter_b.trace();
}

/// A turn r about the centroid moves a point d = scale R (p_b - centroid) by r x d; the information about r is sum w |d x .|^2.
void solve_covariance(const Moments& m, Alignment* alignment) {
  const Eigen::Matrix3d R_a_b = alignment->T_a_b.rotation.toRotationMatrix();
  const double squared_scale = alignment->scale * alignment->scale;
  const Eigen::Matrix3d scatter = squared_scale * (R_a_b * m.scatter_b * R_a_b.transpose());
  const Eigen::Matrix3d information = scatter.trace() * Eigen::Matrix3d::Identity() - scatter;
  constexpr double kFreeVariance = std::numbers::pi * std::numbers::pi;
  Eigen::Matrix3d turn = kFreeVariance * Eigen::Matrix3d::Identity();
  if (alignment->rank == AlignmentRank::kFull) turn = information.inverse();
  if (alignment->rank == AlignmentRank::kLine) {
    const Eigen::Vector3d& axis = alignment->free_axis;
    const Eigen::Matrix3d along = axis * axis.transpose();
    turn = (Eigen::Matrix3d::Identity() - along) / scatter.trace() + kFreeVariance * along;
  }
  // t = centroid_a - scale R centroid_b: a turn r moves it by -r x lever.
  const Eigen::Matrix3d lever = cross_matrix(alignment->scale * (R_a_b * m.centroid_b));
  alignment->covariance.topLeftCorner<3, 3>() = Eigen::Matrix3d::Identity() / m.weight + lever * turn * lever.transpose();
  alignment->covariance.topRightCorner<3, 3>() = lever * turn;
  alignment->covariance.bottomLeftCorner<3, 3>() = (lever * turn).transpose();
  alignment->covariance.bottomRightCorner<3, 3>() = turn;
  if (m.scatter_b.trace() > 0) alignment->scale_sigma = 1 / std::sqrt(m.scatter_b.trace());
}

void sum_residuals(std::span<const PointPair> pairs, bool is_scale_free, Alignment* alignment) {
  double sum_squared = 0;
  for (const PointPair& pair : pairs) {
    const double squared = (pair.p_a - alignment->map(pair.p_b)).squaredNorm();
    sum_squared += squared;
    alignment->chi_squared += squared / (pair.sigma_m * pair.sigma_m);
  }
  alignment->rms_m = std::sqrt(sum_squared / static_cast<double>(pairs.size()));
  int num_parameters = alignment->rank == AlignmentRank::kFull ? 6 : alignment->rank == AlignmentRank::kLine ? 5 : 3;
  if (is_scale_free && alignment->rank != AlignmentRank::kPosition) ++num_parameters;
  alignment->degrees_of_freedom = std::max(0, 3 * static_cast<int>(pairs.size()) - num_parameters);
}

Alignment align(std::span<const PointPair> pairs, bool is_scale_free) {
  Alignment alignment;
  if (pairs.empty()) {
    alignment.covariance.diagonal() << Eigen::Vector3d::Constant(kUnknownPositionM * kUnknownPositionM),
        Eigen::Vector3d::Constant(std::numbers::pi * std::numbers::pi);
    return alignment;
  }
  const Moments moments = moments_of(pairs);
  solve_rotation_and_scale(moments, is_scale_free, &alignment);
  const Eigen::Vector3d turned = alignment.T_a_b.rotation * moments.centroid_b;
  alignment.T_a_b.translation = moments.centroid_a - alignment.scale * turned;
  solve_covariance(moments, &alignment);
  sum_residuals(pairs, is_scale_free, &alignment);
  return alignment;
}

}  // namespace

void add_pose_points(const Rigid3& T_a_camera, const Rigid3& T_b_camera, double lever_m, std::vector<PointPair>* pairs) {
  pairs->push_back({T_a_camera.translation, T_b_camera.translation});
  for (int axis = 0; axis < 3 && lever_m > 0; ++axis) {
    const Eigen::Vector3d tip = lever_m * Eigen::Vector3d::Unit(axis);
    pairs->push_back({T_a_camera * tip, T_b_camera * tip});
  }
}

Alignment align_rigid(std::span<const PointPair> pairs) { return align(pairs, false); }
Alignment align_similarity(std::span<const PointPair> pairs) { return align(pairs, true); }

double LeaveOneOutResidual::sigmas() const { return std::sqrt(std::max(0.0, error_m.dot(solve_symmetric<3>(covariance, error_m)))); }

LeaveOneOutResidual predicted_residual(const Alignment& alignment, const PointPair& pair) {
  LeaveOneOutResidual residual;
  residual.error_m = pair.p_a - alignment.map(pair.p_b);
  Eigen::Matrix<double, 3, 6> jacobian;
  jacobian << Eigen::Matrix3d::Identity(), -cross_matrix(alignment.T_a_b.rotation * pair.p_b);
  residual.covariance = jacobian * alignment.covariance * jacobian.transpose() + pair.sigma_m * pair.sigma_m * Eigen::Matrix3d::Identity();
  residual.is_determined = alignment.rank == AlignmentRank::kFull;
  return residual;
}

std::vector<LeaveOneOutResidual> leave_one_out(std::span<const PointPair> pairs) {
  std::vector<LeaveOneOutResidual> residuals;
  std::vector<PointPair> others;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    others.assign(pairs.begin(), pairs.end());
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    residuals.push_back(predicted_residual(align_rigid(others), pairs[i]));
  }
  return residuals;
}

}  // namespace camloc
