// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Each iteration pairs the points with the planes of the cloud, keeps the closest, and solves one weighted Gauss-Newton step for the
// motion (and the scale, where asked). The last iterations see all correspondences, so that trimming biases nothing.
#include "tools/mapping/cloud/cloud_registration.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/base/order_statistics.h"
#include "core/geometry/symmetric_system.h"
#include "tools/mapping/cloud/point_cloud.h"

namespace camloc::mapping {
namespace {

using Matrix7d = Eigen::Matrix<double, 7, 7>;
using Vector7d = Eigen::Matrix<double, 7, 1>;

constexpr std::size_t kMinCorrespondences = 10;
constexpr double kShrink = 0.7;  // of the distance limit, an iteration
constexpr double kMinKernelM = 0.002;
constexpr double kStillM = 2e-5, kStillRad = 2e-6;          // nothing will change any more
constexpr double kConvergedM = 3e-4, kConvergedRad = 2e-4;  // correspondences that flip between points keep it moving this much
constexpr int kFinalIterations = 10;

struct Correspondence {
  Eigen::Vector3d p;  ///< landmark in the cloud's frame
  CloudIndex::Neighbor neighbor;
};

/// Normal equations of the plane distances; unknowns: rotation vector, translation, scale, about `center`.
struct Equations {
  Matrix7d information = Matrix7d::Zero();
  Vector7d gradient = Vector7d::Zero();
  Eigen::Matrix3d normals = Eigen::Matrix3d::Zero();  ///< mean of n n^T
  double sum_squares = 0, sum_weights = 0;
};

Equations build_equations(const std::vector<Correspondence>& pairs, CloudIndex* cloud, const Eigen::Vector3d& center) {
  std::vector<double> residuals, sizes;
  for (const Correspondence& pair : pairs) {
    const CloudIndex::Plane& plane = cloud->plane_at(pair.neighbor.index);
    residuals.push_back(plane.normal.dot(pair.p - plane.point_m));
    sizes.push_back(std::abs(residuals.back()));
  }
  const double kernel_m = std::max(kMinKernelM, 2 * 1.4826 * upper_median(sizes));
  Equations equations;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Eigen::Vector3d arm = pairs[i].p - center;
    const Eigen::Vector3d& normal = cloud->plane_at(pairs[i].neighbor.index).normal;
    Vector7d jacobian;
    jacobian << arm.cross(normal), normal, normal.dot(arm);
    const double weight = 1 / (1 + residuals[i] * residuals[i] / (kernel_m * kernel_m));
    equations.information += weight * jacobian * jacobian.transpose();
    equations.gradient += weight * residuals[i] * jacobian;
    equations.normals += weight * normal * normal.transpose();
    equations.sum_squares += weight * residuals[i] * residuals[i];
    equations.sum_weights += weight;
  }
  return equations;
}

std::vector<Correspondence> find_correspondences(const std::vector<Eigen::Vector3d>& points_map, const CloudIndex& cloud,
                                                 const Similarity3& T_cloud_map, double max_distance_m, double trim) {
  std::vector<Correspondence> pairs;
  for (const Eigen::Vector3d& p_map : points_map) {
    const Eigen::Vector3d p = T_cloud_map * p_map;
    if (const auto neighbor = cloud.nearest(p, max_distance_m)) pairs.push_back({p, *neighbor});
  }
  const auto num_kept =
      std::max(std::min(kMinCorrespondences, pairs.size()), static_cast<std::size_t>(trim * static_cast<double>(pairs.size())));
  if (num_kept < pairs.size()) {
    const auto is_closer = [](const Correspondence& a, const Correspondence& b) { return a.neighbor.distance_m < b.neighbor.distance_m; };
    std::nth_element(pairs.begin(), pairs.begin() + static_cast<std::ptrdiff_t>(num_kept), pairs.end(), is_closer);
    pairs.resize(num_kept);
  }
  return pairs;
}

Eigen::Vector3d mean_of(const std::vector<Correspondence>& pairs) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Correspondence& pair : pairs) sum += pair.p;
  return sum / static_cast<double>(pairs.size());
}

/// The step that solves the equations, applied about `center`; returns it.
Vector7d take_step(const Equations& equations, const Eigen::Vector3d& center, bool has_scale, Similarity3* T_cloud_map) {
  Matrix7d information = equations.information;
  information.diagonal().array() += 1e-6 * information.diagonal().array() + 1e-9;  // directions nothing holds stay where they are
  Vector7d step = Vector7d::Zero();
  if (has_scale) {
    step = -solve_symmetric<7>(information, equations.gradient);
  } else {
    step.head<6>() = -solve_symmetric<6>(information.topLeftCorner<6, 6>(), equations.gradient.head<6>());
  }
  if (!step.allFinite()) return Vector7d::Zero();
  const Eigen::Quaterniond turn = exp_so3(step.head<3>());
  const double grow = std::clamp(1 + step[6], 0.5, 2.0);
  T_cloud_map->rigid.translation = center + step.segment<3>(3) + grow * (turn * (T_cloud_map->rigid.translation - center));
  T_cloud_map->rigid.rotation = (turn * T_cloud_map->rigid.rotation).normalized();
  T_cloud_map->scale *= grow;
  return step;
}

void describe(const Equations& equations, bool has_scale, std::size_t num_pairs, Registration* result) {
  result->num_correspondences = num_pairs;
  result->rms_m = std::sqrt(equations.sum_squares / std::max(1e-12, equations.sum_weights));
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(equations.normals / std::max(1e-12, equations.sum_weights));
  result->weakest_share = std::max(0.0, solver.eigenvalues()[0]);
  result->weakest_direction = solver.eigenvectors().col(0);
  if (!has_scale) return;
  const Vector7d of_scale = solve_symmetric<7>(equations.information, Vector7d::Unit(6));  // a column of the covariance
  result->sigma_scale = result->rms_m * std::sqrt(std::max(0.0, of_scale[6]));
}

}  // namespace

Result<Registration> register_points(std::span<const Eigen::Vector3d> points_map, CloudIndex* cloud, const Similarity3& start,
                                     const RegistrationOptions& options) {
  const std::vector<Eigen::Vector3d> points = chosen_evenly(points_map, options.max_points);
  Registration result;
  result.T_cloud_map = start;
  result.num_points = points.size();
  double limit_m = std::max(options.start_distance_m, options.max_distance_m), trim = options.trim;
  int num_final = 0;
  for (; result.num_iterations < options.max_iterations; ++result.num_iterations) {
    const auto pairs = find_correspondences(points, *cloud, result.T_cloud_map, limit_m, trim);
    if (pairs.size() < kMinCorrespondences) {
      return {ErrorCode::kInvalid, "only " + std::to_string(pairs.size()) + " of " + std::to_string(points.size()) +
                                       " landmarks have a point of the cloud within " + std::to_string(limit_m).substr(0, 4) + " m"};
    }
    const Eigen::Vector3d center = mean_of(pairs);
    const Equations equations = build_equations(pairs, cloud, center);
    const Vector7d step = take_step(equations, center, options.has_scale, &result.T_cloud_map);
    describe(equations, options.has_scale, pairs.size(), &result);
    const auto is_below = [&](double step_m, double step_rad) {
      return step.head<3>().norm() < step_rad && step.segment<3>(3).norm() < step_m && std::abs(step[6]) < step_rad;
    };
    const bool is_still = is_below(kStillM, kStillRad);
    if (trim < 1 &&
        ((is_still && limit_m <= options.max_distance_m) || result.num_iterations >= options.max_iterations - kFinalIterations)) {
      trim = 1;
    } else if (trim >= 1) {
      result.is_converged = is_below(kConvergedM, kConvergedRad);
      if (is_still || ++num_final >= kFinalIterations) break;
    }
    limit_m = std::max(options.max_distance_m, kShrink * limit_m);
  }
  return result;
}

double capped_mean_distance(std::span<const Eigen::Vector3d> points_map, const CloudIndex& cloud, const Rigid3& T_cloud_map,
                            double max_distance_m) {
  double sum = 0;
  for (const Eigen::Vector3d& p : points_map) {
    const auto neighbor = cloud.nearest(T_cloud_map * p, max_distance_m);
    sum += neighbor ? neighbor->distance_m : max_distance_m;
  }
  return points_map.empty() ? 0 : sum / static_cast<double>(points_map.size());
}

}  // namespace camloc::mapping
