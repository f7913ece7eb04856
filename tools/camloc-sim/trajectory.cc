// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/camloc-sim/trajectory.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tools/camloc-sim/noise.h"

namespace camloc::sim {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kStep = 0.01;     // seconds between samples
constexpr double kSpacing = 0.02;  // metres between points of the resampled path

/// Moving average over 2 * radius + 1 values, ends held.
template <typename T>
std::vector<T> box_filter(const std::vector<T>& in, int radius) {
  const int n = static_cast<int>(in.size());
  const auto at = [&](int i) { return in[static_cast<std::size_t>(std::clamp(i, 0, n - 1))]; };
  std::vector<T> out(in.size());
  T sum = at(0) * 0.0;
  for (int i = -radius; i <= radius; ++i) sum = sum + at(i);
  for (int i = 0; i < n; ++i) {
    out[static_cast<std::size_t>(i)] = sum * (1.0 / (2 * radius + 1));
    sum = sum + at(i + radius + 1) - at(i - radius);
  }
  return out;
}

/// Three box filters come close to a Gaussian of the given sigma (in samples).
template <typename T>
std::vector<T> gaussian_filter(const std::vector<T>& in, double sigma) {
  const int radius = std::max(1, static_cast<int>(std::lround(sigma)));
  return box_filter(box_filter(box_filter(in, radius), radius), radius);
}

std::vector<Eigen::Vector2d> resample(const std::vector<Eigen::Vector2d>& path) {
  std::vector<Eigen::Vector2d> points;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const Eigen::Vector2d step = path[i + 1] - path[i];
    const int count = std::max(1, static_cast<int>(std::lround(step.norm() / kSpacing)));
    for (int k = 0; k < count; ++k) points.push_back(path[i] + step * k / count);
  }
  points.push_back(path.back());
  return points;
}

struct PathPoint {
  Eigen::Vector2d position;
  double heading = 0, speed = 0;
};

std::vector<PathPoint> plan(const std::vector<Eigen::Vector2d>& path, const WalkStyle& style) {
  const std::vector<Eigen::Vector2d> points = gaussian_filter(resample(path), 0.30 / kSpacing);
  std::vector<double> heading(points.size(), 0.0), speed(points.size(), style.speed_m_s);
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Eigen::Vector2d step = points[i] - points[i - 1];
    const double raw = step.norm() > 1e-6 ? std::atan2(step.y(), step.x()) : heading[i - 1];
    heading[i] = i == 1 ? raw : heading[i - 1] + std::remainder(raw - heading[i - 1], 2 * kPi);
  }
  heading[0] = heading[1];
  heading = gaussian_filter(heading, 0.20 / kSpacing);  // eyes turn before the feet do
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double curvature = std::fabs(heading[i] - heading[i - 1]) / std::max(1e-4, (points[i] - points[i - 1]).norm());
    speed[i] = std::clamp(style.turn_rate_rad_s / std::max(curvature, 1e-6), 0.12, style.speed_m_s);
  }
  // Brake before the bend: the slowest point of the neighbourhood, then smooth.
  std::vector<double> slow(speed);
  const int reach = static_cast<int>(0.12 / kSpacing), n = static_cast<int>(speed.size());
  for (int i = 0; i < n; ++i) {
    for (int k = std::max(0, i - reach); k <= std::min(n - 1, i + reach); ++k)
      slow[static_cast<std::size_t>(i)] = std::min(slow[static_cast<std::size_t>(i)], speed[static_cast<std::size_t>(k)]);
  }
  slow = gaussian_filter(slow, 0.05 / kSpacing);
  std::vector<PathPoint> result;
  for (std::size_t i = 0; i < points.size(); ++i) result.push_back({points[i], heading[i], slow[i]});
  return result;
}

/// Sum of slow sines, in [-1, 1]: where attention wanders.
double wander(double t, std::uint32_t seed, double period_s) {
  double sum = 0;
  for (std::uint32_t k = 0; k < 3; ++k) {
    const double period = period_s * range(hash32(seed, k), 0.7F, 1.6F), phase = 2 * kPi * unit(hash32(seed, k + 10));
    sum += std::sin(2 * kPi * t / period + phase);
  }
  return sum / 3.0;
}

}  // namespace

Trajectory::Trajectory(const std::vector<Eigen::Vector2d>& path, const WalkStyle& style) {
  const std::vector<PathPoint> points = plan(path, style);
  double index = 0, steps = 0;
  for (double t = 0; index < static_cast<double>(points.size() - 1); t += kStep) {
    const auto i = static_cast<std::size_t>(index);
    const double f = index - static_cast<double>(i);
    const PathPoint &a = points[i], &b = points[i + 1];
    const double speed = a.speed + f * (b.speed - a.speed);
    const double heading = a.heading + f * (b.heading - a.heading);
    const Eigen::Vector2d p = a.position + f * (b.position - a.position);
    // A step every 0.65 m; the head moves less when walking slowly.
    const double gait = std::min(1.0, speed / 0.8), phase = 2 * kPi * steps;
    const double sway = 0.012 * gait * std::sin(0.5 * phase);
    Sample s;
    s << p.x() - sway * std::sin(heading), p.y() + sway * std::cos(heading),
        style.height_m + 0.015 * gait * std::sin(phase) + 0.03 * wander(t, style.seed + 1, 19.0),
        heading + style.look_rad * wander(t, style.seed + 2, 8.0) + 0.008 * gait * std::sin(0.5 * phase + 0.6),
        style.pitch_rad + 0.14 * wander(t, style.seed + 3, 7.0) + 0.008 * gait * std::sin(phase + 1.0),
        0.03 * wander(t, style.seed + 4, 5.0) + 0.010 * gait * std::sin(0.5 * phase + 2.0);
    samples_.push_back(s);
    index += speed * kStep / std::max(1e-4, (b.position - a.position).norm());
    steps += speed * kStep / 0.65;
  }
  samples_ = gaussian_filter(samples_, 0.06 / kStep);
}

double Trajectory::duration_s() const { return kStep * static_cast<double>(samples_.size() - 1); }

Rigid3 Trajectory::pose(double time_s) const {
  const double x = std::clamp(time_s / kStep, 0.0, static_cast<double>(samples_.size() - 1));
  const std::size_t i = std::min(static_cast<std::size_t>(x), samples_.size() - 2);
  const double f = x - static_cast<double>(i);
  const Sample sample = samples_[i] + f * (samples_[i + 1] - samples_[i]);
  const double yaw = sample[3], pitch = sample[4], roll = sample[5];
  const Eigen::Vector3d forward(std::cos(yaw) * std::cos(pitch), std::sin(yaw) * std::cos(pitch), std::sin(pitch));
  const Eigen::Vector3d right(std::sin(yaw), -std::cos(yaw), 0.0);
  const Eigen::Vector3d down = forward.cross(right);
  Eigen::Matrix3d R;
  R.col(0) = std::cos(roll) * right + std::sin(roll) * down;
  R.col(1) = std::cos(roll) * down - std::sin(roll) * right;
  R.col(2) = forward;
  return {Eigen::Quaterniond(R).normalized(), sample.head<3>()};
}

Trajectory::Twist Trajectory::twist(double time_s) const {
  constexpr double kHalf = 0.01;
  const Rigid3 before = pose(time_s - kHalf), after = pose(time_s + kHalf), now = pose(time_s);
  const double span = 2 * kHalf;
  return {now.rotation.conjugate() * ((after.translation - before.translation) / span),
          log_so3(before.rotation.conjugate() * after.rotation) / span};
}

}  // namespace camloc::sim
