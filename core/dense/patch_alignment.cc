// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/dense/patch_alignment.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace camloc {
namespace {

constexpr int kRadius = 5, kSide = 2 * kRadius + 1;
constexpr double kWeightSigmaPx = 3.5;
constexpr double kMinVariance = 9;    // grey levels squared, below which there is nothing to align
constexpr double kNoiseVariance = 4;  // of a pixel, at least: sensor noise and compression
constexpr double kCorrelated = 4;     // neighbouring pixels of a smoothed image do not err independently
constexpr int kMaxIterations = 15;
constexpr double kMaxShiftPx = 2.5;      // pixels of the target's level
constexpr double kMinCorrelation = 0.8;  // of the two patches once they are aligned, brightness and contrast aside
constexpr double kMaxSigmaPx = 0.7;      // of the position, in the direction in which it is known least; a detector is not better
constexpr double kMaxStepPx = 1.0, kSettledPx = 0.01, kUnsettledPx = 0.1;

/// Pixels within the circle, as offsets from its middle, with their weights.
struct Window {
  struct Pixel {
    int dx, dy;
    double weight;
  };
  std::array<Pixel, kSide * kSide> pixels{};
  std::size_t size = 0;
  double sum = 0;
};

Window make_window() {
  Window window;
  for (int dy = -kRadius; dy <= kRadius; ++dy) {
    for (int dx = -kRadius; dx <= kRadius; ++dx) {
      const int squared = dx * dx + dy * dy;
      if (squared > kRadius * kRadius) continue;
      const double weight = std::exp(-squared / (2 * kWeightSigmaPx * kWeightSigmaPx));
      window.pixels[window.size++] = {dx, dy, weight};
      window.sum += weight;
    }
  }
  return window;
}

/// Bilinear; negative outside.
double grey_at(const FeaturePatch& patch, double x, double y) {
  const double column = std::floor(x), row = std::floor(y);
  if (!(column >= -FeaturePatch::kHalf && row >= -FeaturePatch::kHalf && column < FeaturePatch::kHalf && row < FeaturePatch::kHalf))
    return -1;
  const int dx = static_cast<int>(column), dy = static_cast<int>(row);
  const double a = x - column, b = y - row;
  return (1 - b) * ((1 - a) * patch.at(dx, dy) + a * patch.at(dx + 1, dy)) +
         b * ((1 - a) * patch.at(dx, dy + 1) + a * patch.at(dx + 1, dy + 1));
}

/// What the target should look like around the point, and how that changes with the position; all without their means.
struct Template {
  std::array<double, kSide * kSide> grey{}, along_x{}, along_y{};
  double variance = 0;
  Eigen::Matrix2d gradients = Eigen::Matrix2d::Zero();  ///< weighted sum of their products
};

void subtract_mean(const Window& window, std::array<double, kSide * kSide>* values) {
  double mean = 0;
  for (std::size_t i = 0; i < window.size; ++i) mean += window.pixels[i].weight * (*values)[i];
  mean /= window.sum;
  for (std::size_t i = 0; i < window.size; ++i) (*values)[i] -= mean;
}

std::optional<Template> make_template(const Window& window, const FeaturePatch& reference, const Eigen::Matrix2d& A_reference_target) {
  std::array<std::array<double, kSide + 2>, kSide + 2> warped;
  for (int dy = -kRadius - 1; dy <= kRadius + 1; ++dy) {
    for (int dx = -kRadius - 1; dx <= kRadius + 1; ++dx) {
      const Eigen::Vector2d at = A_reference_target * Eigen::Vector2d(dx, dy);
      warped[static_cast<std::size_t>(dy + kRadius + 1)][static_cast<std::size_t>(dx + kRadius + 1)] = grey_at(reference, at.x(), at.y());
    }
  }
  Template made;
  for (std::size_t i = 0; i < window.size; ++i) {
    const auto x = static_cast<std::size_t>(window.pixels[i].dx + kRadius + 1),
               y = static_cast<std::size_t>(window.pixels[i].dy + kRadius + 1);
    const double left = warped[y][x - 1], right = warped[y][x + 1], above = warped[y - 1][x], below = warped[y + 1][x];
    if (std::min({warped[y][x], left, right, above, below}) < 0) return std::nullopt;
    made.grey[i] = warped[y][x];
    made.along_x[i] = 0.5 * (right - left);
    made.along_y[i] = 0.5 * (below - above);
  }
  subtract_mean(window, &made.grey);
  subtract_mean(window, &made.along_x);
  subtract_mean(window, &made.along_y);
  for (std::size_t i = 0; i < window.size; ++i) {
    const Eigen::Vector2d gradient(made.along_x[i], made.along_y[i]);
    made.variance += window.pixels[i].weight * made.grey[i] * made.grey[i] / window.sum;
    made.gradients += window.pixels[i].weight * gradient * gradient.transpose();
  }
  return made;
}

/// The target at one position beside the template.
struct Comparison {
  double contrast = 0, correlation = 0, residual_variance = 0;
  Eigen::Vector2d step = Eigen::Vector2d::Zero();
};

std::optional<Comparison> compare(const Window& window, const Template& wanted, const FeaturePatch& target,
                                  const Eigen::Vector2d& position) {
  std::array<double, kSide * kSide> grey;
  for (std::size_t i = 0; i < window.size; ++i) {
    grey[i] = grey_at(target, position.x() + window.pixels[i].dx, position.y() + window.pixels[i].dy);
    if (grey[i] < 0) return std::nullopt;
  }
  subtract_mean(window, &grey);
  double variance = 0, covariance = 0;
  for (std::size_t i = 0; i < window.size; ++i) {
    variance += window.pixels[i].weight * grey[i] * grey[i] / window.sum;
    covariance += window.pixels[i].weight * grey[i] * wanted.grey[i] / window.sum;
  }
  Comparison found;
  if (!(covariance > 0)) return found;
  found.contrast = covariance / wanted.variance;
  found.correlation = covariance / std::sqrt(variance * wanted.variance);
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < window.size; ++i) {
    const double residual = grey[i] / found.contrast - wanted.grey[i];
    sum += window.pixels[i].weight * residual * Eigen::Vector2d(wanted.along_x[i], wanted.along_y[i]);
    found.residual_variance += window.pixels[i].weight * residual * residual / window.sum;
  }
  found.step = -(wanted.gradients.inverse() * sum);
  return found;
}

/// Standard deviation of the position along the direction in which the texture says least.
double worst_sigma_px(const Template& wanted, const Comparison& found) {
  const double half_trace = 0.5 * wanted.gradients.trace();
  const double least = half_trace - std::sqrt(std::max(half_trace * half_trace - wanted.gradients.determinant(), 0.0));
  const double noise = std::max(found.residual_variance, kNoiseVariance / (found.contrast * found.contrast));
  return std::sqrt(kCorrelated * noise / std::max(least, 1e-12));
}

}  // namespace

PatchAlignment align_patch(const FeaturePatch& reference, const Eigen::Matrix2d& A_reference_target, const FeaturePatch& target) {
  static const Window window = make_window();
  PatchAlignment result;
  const std::optional<Template> wanted = make_template(window, reference, A_reference_target);
  if (!wanted) return {PatchVerdict::kOutside, {}, 0, 0};
  if (!(wanted->variance >= kMinVariance) || !(wanted->gradients.determinant() > 1e-6)) return {PatchVerdict::kFlat, {}, 0, 0};
  Comparison found;
  double last_step_px = kMaxStepPx;
  for (int i = 0; i < kMaxIterations && last_step_px > kSettledPx; ++i) {
    const std::optional<Comparison> compared = compare(window, *wanted, target, result.shift_px);
    if (!compared) return result;
    found = *compared;
    result.correlation = found.correlation;
    if (!(found.correlation > 0)) return result;
    last_step_px = found.step.norm();
    result.shift_px += last_step_px > kMaxStepPx ? (kMaxStepPx / last_step_px * found.step).eval() : found.step;
    if (result.shift_px.norm() > 1.5 * kMaxShiftPx) return result;
  }
  if (last_step_px > kUnsettledPx || result.shift_px.norm() > kMaxShiftPx) return result;
  result.sigma_px = worst_sigma_px(*wanted, found);
  if (result.correlation < kMinCorrelation)
    result.verdict = PatchVerdict::kUnlike;
  else
    result.verdict = result.sigma_px <= kMaxSigmaPx ? PatchVerdict::kAligned : PatchVerdict::kFlat;
  return result;
}

}  // namespace camloc
