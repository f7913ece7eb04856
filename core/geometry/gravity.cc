// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Up from an accelerometer. The floor is in floor_plane.cc.
#include "core/geometry/gravity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "core/base/order_statistics.h"

namespace camloc {
namespace {

constexpr int kMaxMedianSteps = 100;
/// Readings follow each other: this many of them say as much as one that is independent.
constexpr double kReadingsPerIndependent = 10;
constexpr double kMinRoughLength = 0.3;
constexpr double kMaxNormErrorMS2 = 1.5;  // from standard gravity: a reading while the camera is being pushed says nothing
constexpr double kMaxScatterRad = 0.17;   // 10 degrees; above this the axes, the poses or the clock are wrong
constexpr double kBiasSigmaRad = 0.0175;  // 1 degree, what the sensor itself is good for
constexpr std::size_t kMinReadings = 20;

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

/// Unit vectors up, one per reading that is no push.
std::vector<Eigen::Vector3d> directions_up(std::span<const OrientedReading> readings) {
  const Eigen::Matrix3d R_camera_accelerometer = kinect_R_camera_accelerometer();
  std::vector<Eigen::Vector3d> directions;
  for (const OrientedReading& reading : readings) {
    const double norm = reading.acceleration.norm();
    if (!(std::abs(norm - kStandardGravity) <= kMaxNormErrorMS2)) continue;
    directions.push_back(reading.R_map_camera * (R_camera_accelerometer * (reading.acceleration / norm)));
  }
  return directions;
}

/// The point with the least sum of distances (Weiszfeld, 1937), as a direction.
Eigen::Vector3d median_direction(const std::vector<Eigen::Vector3d>& directions) {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& direction : directions) center += direction;
  center /= static_cast<double>(directions.size());
  for (int step = 0; step < kMaxMedianSteps; ++step) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double weight = 0;
    for (const Eigen::Vector3d& direction : directions) {
      const double w = 1 / std::max(1e-6, (direction - center).norm());
      weight += w;
      sum += w * direction;
    }
    const Eigen::Vector3d next = sum / weight;
    const double change = (next - center).norm();
    center = next;
    if (change < 1e-9) break;
  }
  return center.norm() > 1e-9 ? Eigen::Vector3d(center.normalized()) : directions.front();
}

struct RobustMean {
  Eigen::Vector3d direction;
  double median_angle_rad = 0;  ///< to the median direction
  double rms_rad = 0;           ///< of the inliers
  std::size_t num_inliers = 0;
};

RobustMean robust_mean(const std::vector<Eigen::Vector3d>& directions) {
  RobustMean result;
  const Eigen::Vector3d center = median_direction(directions);
  std::vector<double> angles;
  for (const Eigen::Vector3d& direction : directions) angles.push_back(angle_between(direction, center));
  result.median_angle_rad = upper_median(angles);
  // The angle of a two-dimensional normal error has its median at 1.18 sigma; three sigma hold 99 % of them.
  const double limit = std::max(1e-6, 3 * result.median_angle_rad / 1.18);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double sum_squared = 0;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    if (angles[i] > limit) continue;
    sum += directions[i];
    sum_squared += angles[i] * angles[i];
    ++result.num_inliers;
  }
  result.direction = sum.normalized();
  result.rms_rad = std::sqrt(sum_squared / static_cast<double>(result.num_inliers));
  return result;
}

std::string in_degrees(double angle_rad) { return std::to_string(std::lround(angle_rad * 57.29577951308232)) + " degrees"; }

}  // namespace

std::optional<Eigen::Vector3d> rough_up(std::span<const Rigid3> T_map_camera) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Rigid3& T : T_map_camera) sum -= T.rotation * Eigen::Vector3d::UnitY();
  if (T_map_camera.empty() || sum.norm() < kMinRoughLength * static_cast<double>(T_map_camera.size())) return std::nullopt;
  return sum.normalized();
}

Eigen::Matrix3d kinect_R_camera_accelerometer() { return Eigen::Vector3d(-1, -1, 1).asDiagonal(); }

Result<GravityEstimate> gravity_from_accelerometer(std::span<const OrientedReading> readings) {
  const std::vector<Eigen::Vector3d> directions = directions_up(readings);
  if (directions.size() < kMinReadings) {
    return {ErrorCode::kInvalid, "only " + std::to_string(directions.size()) + " of " + std::to_string(readings.size()) +
                                     " accelerometer readings are of a camera with a pose that is not being pushed; " +
                                     std::to_string(kMinReadings) + " are needed"};
  }
  const RobustMean mean = robust_mean(directions);
  if (mean.median_angle_rad > kMaxScatterRad) {
    return {ErrorCode::kInvalid, "accelerometer readings point up to different sides, " + in_degrees(mean.median_angle_rad) +
                                     " from each other's mean; check the order and signs of its axes, its clock, and that it belongs to "
                                     "these poses"};
  }
  GravityEstimate estimate;
  estimate.source = GravitySource::kAccelerometer;
  estimate.up_map = mean.direction;
  estimate.inlier_share = static_cast<double>(mean.num_inliers) / static_cast<double>(directions.size());
  const double num_independent = std::max(1.0, static_cast<double>(mean.num_inliers) / kReadingsPerIndependent);
  estimate.sigma_rad = std::hypot(mean.rms_rad / std::sqrt(num_independent), kBiasSigmaRad);
  return estimate;
}

}  // namespace camloc
