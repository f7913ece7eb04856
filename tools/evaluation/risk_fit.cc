// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/evaluation/risk_fit.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/order_statistics.h"

namespace camloc::tools {
namespace {

constexpr int kMaxSweeps = 400;
/// A prior of this standard deviation: without faults in some direction its weight would grow without end.
constexpr double kWeightSigma = 10;
constexpr double kSettled = 1e-5;

using Weights = std::array<double, kNumRiskFeatures + 1>;

double value_of(const JudgedPose& pose, std::size_t k) { return k == 0 ? 1.0 : pose.features[k - 1]; }

/// One Newton step along a coordinate; returns how far it went.
double improve(std::span<const JudgedPose> poses, std::size_t k, std::vector<double>* log_odds, Weights* weights) {
  double gradient = 0, curvature = 1e-9;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const double is_right = 1.0 / (1.0 + std::exp(-(*log_odds)[i])), x = value_of(poses[i], k);
    gradient += ((poses[i].is_misleading ? 0.0 : 1.0) - is_right) * x;
    curvature += is_right * (1 - is_right) * x * x;
  }
  if (k > 0) {
    gradient -= (*weights)[k] / (kWeightSigma * kWeightSigma);
    curvature += 1 / (kWeightSigma * kWeightSigma);
  }
  const double before = (*weights)[k], step = std::clamp(gradient / curvature, -1.0, 1.0);
  (*weights)[k] = k == 0 ? before + step : std::max(0.0, before + step);
  const double change = (*weights)[k] - before;
  for (std::size_t i = 0; i < poses.size(); ++i) (*log_odds)[i] += change * value_of(poses[i], k);
  return std::abs(change);
}

double quantile_of(std::span<const JudgedPose> poses, double fraction, double (*value)(const JudgedPose&)) {
  std::vector<double> values;
  for (const JudgedPose& pose : poses) {
    if (pose.is_localized && !pose.is_misleading) values.push_back(value(pose));
  }
  return values.empty() ? 0 : lower_quantile(std::move(values), fraction);
}

}  // namespace

RiskFit fit_risk(std::span<const JudgedPose> poses) {
  RiskFit fit;
  std::vector<double> log_odds(poses.size(), 0.0);
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    double largest = 0;
    for (std::size_t k = 0; k < fit.weights.size(); ++k) largest = std::max(largest, improve(poses, k, &log_odds, &fit.weights));
    if (largest < kSettled) break;
  }
  fit.num_poses = poses.size();
  fit.num_faults =
      static_cast<std::uint64_t>(std::count_if(poses.begin(), poses.end(), [](const JudgedPose& pose) { return pose.is_misleading; }));
  const auto position = [](const JudgedPose& pose) { return pose.error_m / pose.sigma_m; };
  const auto rotation = [](const JudgedPose& pose) { return pose.error_rad / pose.sigma_rad; };
  fit.position_sigmas_95 = quantile_of(poses, 0.95, position);
  fit.position_sigmas_999 = quantile_of(poses, 0.999, position);
  fit.rotation_sigmas_95 = quantile_of(poses, 0.95, rotation);
  fit.rotation_sigmas_999 = quantile_of(poses, 0.999, rotation);
  return fit;
}

}  // namespace camloc::tools
