// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// From observations to points of the map. See control_points.h.
#include <algorithm>
#include <cmath>
#include <map>

#include "tools/common/text_format.h"
#include "tools/mapping/site/control_points.h"

namespace camloc::mapping {
namespace {

/// Squared distance from the mean over variance and degree of freedom, above which measurements contradict each other.
constexpr double kMaxScatterRatio = 16;

Result<PointMeasurement> resolve(const ControlObservation& observation, const RgbdCamera& camera, const ControlSources& sources) {
  if (observation.kind == ObservationKind::kMapPosition) return PointMeasurement{{}, observation.p_map, observation.sigma, {}};
  if (observation.kind == ObservationKind::kLandmark) {
    if (!sources.landmark) return {ErrorCode::kUnavailable, "there is no map to look landmarks up in"};
    Result<PointMeasurement> measurement = sources.landmark(observation.landmark);
    if (measurement && observation.sigma > 0) measurement->sigma_m = observation.sigma;
    return measurement;
  }
  if (!sources.T_map_camera || !sources.pixel) return {ErrorCode::kUnavailable, "there is no recording to look pixels up in"};
  const Result<PoseWithCovariance> T_map_camera = sources.T_map_camera(observation.frame);
  if (!T_map_camera) return T_map_camera.status();
  const Result<PixelMeasurement> measurement = sources.pixel(observation);
  if (!measurement) return measurement.status();
  return to_map(observation, *measurement, camera, *T_map_camera);
}

ObservedPoint average(const std::string& name, const std::vector<const PointMeasurement*>& measurements) {
  ObservedPoint point;
  point.name = name;
  point.num_measurements = measurements.size();
  double weight = 0;
  for (const PointMeasurement* measurement : measurements) {
    const double w = 1 / (measurement->sigma_m * measurement->sigma_m);
    weight += w;
    point.p_map += w * measurement->p_map;
  }
  point.p_map /= weight;
  point.sigma_m = 1 / std::sqrt(weight);
  if (measurements.size() < 2) return point;

  double sum_squared = 0, sum_normalized = 0, farthest = 0;
  const PointMeasurement* farthest_measurement = nullptr;
  for (const PointMeasurement* measurement : measurements) {
    const double squared = (measurement->p_map - point.p_map).squaredNorm();
    sum_squared += squared;
    sum_normalized += squared / (measurement->sigma_m * measurement->sigma_m);
    if (squared > farthest) {
      farthest = squared;
      farthest_measurement = measurement;
    }
  }
  const auto count = static_cast<double>(measurements.size());
  const double freedom = 3 * (count - 1);
  point.scatter_m = std::sqrt(sum_squared / count);
  // Per axis, of the mean.
  point.sigma_m = std::max(point.sigma_m, std::sqrt(sum_squared / freedom / count));
  if (farthest_measurement != nullptr && sum_normalized > kMaxScatterRatio * freedom) point.farthest = farthest_measurement->source;
  return point;
}

}  // namespace

std::string describe(const ControlObservation& observation) {
  switch (observation.kind) {
    case ObservationKind::kMapPosition: return "map position of line " + std::to_string(observation.line);
    case ObservationKind::kLandmark: return "landmark " + std::to_string(observation.landmark);
    case ObservationKind::kPixel: break;
  }
  return tools::text_of("pixel (%.1f, %.1f) of frame %llu", observation.u, observation.v, tools::llu(observation.frame));
}

Result<PixelMeasurement> measure_pixel(const ControlObservation& pixel, const RgbdCamera& camera, const DepthLookup& lookup,
                                       ImageView<std::uint16_t> depth) {
  if (pixel.u > camera.color.width - 0.5 || pixel.v > camera.color.height - 0.5) {
    return {ErrorCode::kInvalid,
            "outside of the image of " + std::to_string(camera.color.width) + "x" + std::to_string(camera.color.height)};
  }
  if (depth.empty()) return {ErrorCode::kNotFound, "the frame has no depth image"};
  if (depth.width != camera.depth.width || depth.height != camera.depth.height) {
    return {ErrorCode::kInvalid, "the depth image has another size than the camera file says"};
  }
  const float depth_m = lookup.depth_at(depth, static_cast<float>(pixel.u), static_cast<float>(pixel.v));
  if (!(depth_m > 0)) return {ErrorCode::kNotFound, "no depth there, or the edge of something; choose a point on a surface"};
  const Eigen::Vector2d normalized = camera.color.undistort({pixel.u, pixel.v});
  return PixelMeasurement{normalized, static_cast<double>(depth_m), pixel.sigma};
}

void measure_pixels(const std::vector<ControlObservation>& observations, const RgbdCamera& camera, const DepthLookup& lookup,
                    const Frame& frame, PixelMeasurements* measurements) {
  for (const ControlObservation& observation : observations) {
    if (observation.kind != ObservationKind::kPixel || observation.frame != frame.sequence) continue;
    measurements->insert_or_assign(observation.line, measure_pixel(observation, camera, lookup, frame.depth));
  }
}

PointMeasurement to_map(const ControlObservation& pixel, const PixelMeasurement& measurement, const RgbdCamera& camera,
                        const PoseWithCovariance& T_map_camera) {
  const double z = measurement.depth_m;
  const Eigen::Vector3d ray(measurement.normalized.x(), measurement.normalized.y(), 1);
  const Eigen::Vector3d turned = T_map_camera.pose.rotation * (z * ray);
  // A pose error (dp, r) moves the point by dp + r x (R p).
  Eigen::Matrix<double, 3, 6> jacobian;
  jacobian.leftCols<3>().setIdentity();
  for (int axis = 0; axis < 3; ++axis) jacobian.col(3 + axis) = Eigen::Vector3d::Unit(axis).cross(turned);
  const Eigen::Matrix3d of_pose = jacobian * T_map_camera.covariance * jacobian.transpose();
  const double across_m = z * measurement.sigma_px / camera.color.mean_focal_px();
  const double along_m = camera.depth_noise.sigma_m(z) * ray.norm();
  const double variance = (of_pose.trace() + 2 * across_m * across_m + along_m * along_m) / 3;
  return {pixel.name, turned + T_map_camera.pose.translation, std::sqrt(variance), describe(pixel)};
}

ResolvedObservations resolve_observations(const std::vector<ControlObservation>& observations, const RgbdCamera& camera,
                                          const ControlSources& sources) {
  ResolvedObservations resolved;
  for (const ControlObservation& observation : observations) {
    Result<PointMeasurement> measurement = resolve(observation, camera, sources);
    if (!measurement) {
      resolved.left_out.push_back(observation.name + ", " + describe(observation) + ": " + measurement.status().message());
      continue;
    }
    measurement->name = observation.name;
    measurement->source = describe(observation);
    resolved.measurements.push_back(*measurement);
  }
  return resolved;
}

std::vector<ObservedPoint> average_measurements(const std::vector<PointMeasurement>& measurements) {
  std::vector<std::string> names;
  std::map<std::string, std::vector<const PointMeasurement*>> by_name;
  for (const PointMeasurement& measurement : measurements) {
    std::vector<const PointMeasurement*>& same = by_name[measurement.name];
    if (same.empty()) names.push_back(measurement.name);
    same.push_back(&measurement);
  }
  std::vector<ObservedPoint> points;
  points.reserve(names.size());
  for (const std::string& name : names) points.push_back(average(name, by_name[name]));
  return points;
}

}  // namespace camloc::mapping
