// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Viewpoints from which a set of points fills a picture; the drawing itself is in point_raster.cc.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/order_statistics.h"
#include "tools/mapping/picture/point_raster.h"

namespace camloc::mapping {
namespace {

constexpr std::size_t kMaxSamples = 20000;  // enough for percentiles, and a cloud of millions costs nothing

std::vector<Eigen::Vector3d> samples_of(std::span<const Eigen::Vector3d> points) {
  std::vector<Eigen::Vector3d> samples;
  const std::size_t step = points.size() / kMaxSamples + 1;
  for (std::size_t i = 0; i < points.size(); i += step)
    if (points[i].allFinite()) samples.push_back(points[i]);
  return samples;
}

Extent percentiles(std::vector<double> values) {
  if (values.empty()) return {-0.5, 0.5};
  const auto [low, high] = trimmed_range(std::move(values), 100);
  return {low, high};
}

Extent range_along(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& axis) {
  std::vector<double> values;
  values.reserve(points.size());
  for (const Eigen::Vector3d& p : points) values.push_back(axis.dot(p));
  return percentiles(std::move(values));
}

/// How much the points crowd at few places along `axis`: walls across it do that.
double concentration(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& axis, const Extent& range, double bin_m) {
  std::vector<double> bins(static_cast<std::size_t>(range.length() / bin_m) + 1);
  for (const Eigen::Vector3d& p : points) {
    const double bin = (axis.dot(p) - range.low) / bin_m;
    if (bin >= 0 && bin < static_cast<double>(bins.size())) ++bins[static_cast<std::size_t>(bin)];
  }
  double sum = 0;
  for (const double count : bins) sum += count * count;
  return sum;
}

/// The direction across `up` in which walls run, of the two the one in which the points reach farther.
Eigen::Vector3d long_side(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& up) {
  const std::vector<Eigen::Vector3d> directions = level_directions(up);
  const double bin_m = std::max(range_along(points, directions[0]).length(), range_along(points, up.cross(directions[0])).length()) / 200;
  Eigen::Vector3d best = directions[0];
  double best_score = -1;
  for (const Eigen::Vector3d& a : directions) {
    const Eigen::Vector3d b = up.cross(a);
    const Extent along_a = range_along(points, a), along_b = range_along(points, b);
    const double score = concentration(points, a, along_a, bin_m) + concentration(points, b, along_b, bin_m);
    if (score <= 1.01 * best_score) continue;  // a turn must be worth it
    best_score = score;
    best = along_a.length() >= along_b.length() ? a : b;
  }
  return turned_positive(best);
}

/// The view with the given axes (rows: right, down, away) in which the points fill the picture.
Viewpoint fit_parallel(const std::vector<Eigen::Vector3d>& points, const Eigen::Matrix3d& axes, int width, int height, int margin_px) {
  return parallel_view(axes, range_along(points, axes.row(0)), range_along(points, axes.row(1)), width, height, margin_px);
}

Eigen::Matrix3d axes_of(const Eigen::Vector3d& right, const Eigen::Vector3d& away) {
  Eigen::Matrix3d axes;
  axes << right.transpose(), away.cross(right).transpose(), away.transpose();
  return axes;
}

}  // namespace

std::vector<Eigen::Vector3d> level_directions(const Eigen::Vector3d& up) {
  Eigen::Index flattest = 0;
  up.cwiseAbs().minCoeff(&flattest);
  const Eigen::Vector3d first = (Eigen::Vector3d::Unit(flattest) - up * up[flattest]).normalized(), second = up.cross(first);
  std::vector<Eigen::Vector3d> directions;
  for (int degrees = 0; degrees < 90; ++degrees) {
    const double angle = degrees * std::numbers::pi / 180;
    directions.push_back(std::cos(angle) * first + std::sin(angle) * second);
  }
  return directions;
}

Eigen::Vector3d turned_positive(const Eigen::Vector3d& axis) {
  Eigen::Index main = 0;
  axis.cwiseAbs().maxCoeff(&main);
  return axis[main] < 0 ? Eigen::Vector3d(-axis) : axis;
}

Viewpoint parallel_view(const Eigen::Matrix3d& axes, const Extent& u, const Extent& v, int width, int height, int margin_px) {
  Viewpoint view;
  view.T_view_world.rotation = Eigen::Quaterniond(axes).normalized();
  view.px_per_m = std::min(std::max(1, width - 2 * margin_px) / u.length(), std::max(1, height - 2 * margin_px) / v.length());
  view.center_u = 0.5 * (width - 1) - view.px_per_m * u.middle();
  view.center_v = 0.5 * (height - 1) - view.px_per_m * v.middle();
  return view;
}

Viewpoint fit_top_view(std::span<const Eigen::Vector3d> points, const Eigen::Vector3d& up, int width, int height, int margin_px) {
  const std::vector<Eigen::Vector3d> samples = samples_of(points);
  const Eigen::Vector3d unit_up = up.normalized();
  return fit_parallel(samples, axes_of(long_side(samples, unit_up), -unit_up), width, height, margin_px);
}

Viewpoint fit_side_view(std::span<const Eigen::Vector3d> points, const Eigen::Vector3d& up, int width, int height, int margin_px) {
  const std::vector<Eigen::Vector3d> samples = samples_of(points);
  const Eigen::Vector3d unit_up = up.normalized();
  const Eigen::Vector3d right = long_side(samples, unit_up);
  return fit_parallel(samples, axes_of(right, unit_up.cross(right)), width, height, margin_px);
}

Viewpoint fit_perspective_view(std::span<const Eigen::Vector3d> points, const Eigen::Vector3d& up, int width, int height, int margin_px) {
  constexpr double kTilt = 0.7, kTurn = 0.5, kDistances = 1.8;  // radians, radians, radii of the scene
  const std::vector<Eigen::Vector3d> samples = samples_of(points);
  const Eigen::Vector3d unit_up = up.normalized(), right = long_side(samples, unit_up), ahead = unit_up.cross(right);
  const Eigen::Vector3d heading = std::cos(kTurn) * ahead + std::sin(kTurn) * right;
  const Eigen::Vector3d away = std::cos(kTilt) * heading - std::sin(kTilt) * unit_up;
  const Eigen::Matrix3d axes = axes_of(away.cross(unit_up).normalized(), away);
  const Extent x = range_along(samples, axes.row(0)), y = range_along(samples, axes.row(1)), z = range_along(samples, axes.row(2));
  const double radius_m = 0.5 * std::sqrt(x.length() * x.length() + y.length() * y.length() + z.length() * z.length());
  Viewpoint view;
  view.is_perspective = true;
  view.T_view_world.rotation = Eigen::Quaterniond(axes).normalized();
  view.T_view_world.translation = -Eigen::Vector3d(x.middle(), y.middle(), z.middle() - kDistances * radius_m);
  std::vector<double> us, vs;
  for (const Eigen::Vector3d& p : samples) {
    const Eigen::Vector3d p_view = view.T_view_world * p;
    if (p_view.z() < 0.1 * radius_m) continue;
    us.push_back(p_view.x() / p_view.z());
    vs.push_back(p_view.y() / p_view.z());
  }
  const Extent u = percentiles(std::move(us)), v = percentiles(std::move(vs));
  const auto fill = [&](int pixels, const Extent& range) {
    return std::max(1, pixels - 2 * margin_px) / std::max(0.01, range.high - range.low);
  };
  view.px_per_m = std::min(fill(width, u), fill(height, v));
  view.center_u = 0.5 * (width - 1) - view.px_per_m * u.middle();
  view.center_v = 0.5 * (height - 1) - view.px_per_m * v.middle();
  return view;
}

}  // namespace camloc::mapping
