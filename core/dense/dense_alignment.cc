// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Gauss-Newton on the pose of b in a, with the prediction as a prior. Each cell of b with depth is projected into a, where grey level
// and inverse depth are interpolated and their slopes give the derivatives; both residuals are weighted by Huber's kernel.
#include "core/dense/dense_alignment.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/base/order_statistics.h"
#include "core/geometry/pose_jacobian.h"

namespace camloc {
namespace {

constexpr int kMaxIterations = 25;
constexpr double kMinGreySigma = 0.5;     // grey levels; the residuals may say more
constexpr double kMinOverlap = 0.35;      // share of cells with depth that fall on cells with depth
constexpr double kMinInlierShare = 0.75;  // of those, that agree in depth
constexpr double kMaxPriorSigmas = 5;     // how far from the prediction the result may be
constexpr double kKernelSigmas = 2;       // Huber
constexpr double kDepthInlierSigmas = 4;
constexpr double kMaxDepthStepShare = 0.05;                     // a cell beside one so much nearer or farther is at an edge
constexpr double kDepthSigmaShare = 0.5, kDepthSigmaM = 0.001;  // an average of cells is better than a pixel, but shares its bias
// Of cells: neighbours share their errors, in grey more than in depth (the sigmas fit the synthetic building's truth).
constexpr double kIndependentGreyShare = 0.01, kIndependentDepthShare = 0.2;
constexpr double kSlopeNoise = 6;  // three times the square of a slope that is nothing but noise, in terms of the residuals'
constexpr int kSlowRadius = 5;     // cells
constexpr double kSettled = 3e-5;  // metres and radians

/// Grey level and inverse depth (1 / m, linear over the image of a plane) between four cells, with their slopes per cell.
struct Surroundings {
  double grey, grey_x, grey_y, inverse, inverse_x, inverse_y;
};

// What varies slowly over an image is the lens's vignetting and the exposure, which go with the camera, more often than the wall.
void remove_slow_changes(const Thumbnail& view, std::vector<float>* grey) {
  Eigen::ArrayXXd sums = Eigen::ArrayXXd::Zero(view.width + 1, view.height + 1);  // of all cells above and to the left
  for (int y = 0; y < view.height; ++y) {
    for (int x = 0; x < view.width; ++x) sums(x + 1, y + 1) = view.grey[view.index(x, y)] + sums(x, y + 1) + sums(x + 1, y) - sums(x, y);
  }
  grey->resize(view.grey.size());
  for (int y = 0; y < view.height; ++y) {
    for (int x = 0; x < view.width; ++x) {
      const int radius = std::min({kSlowRadius, x, y, view.width - 1 - x, view.height - 1 - y});
      const int left = x - radius, right = x + radius + 1, top = y - radius, bottom = y + radius + 1;
      const double sum = sums(right, bottom) - sums(left, bottom) - sums(right, top) + sums(left, top);
      const double mean = sum / ((2 * radius + 1) * (2 * radius + 1));
      (*grey)[view.index(x, y)] = Thumbnail::kGreyUnit * static_cast<float>(view.grey[view.index(x, y)] - mean);
    }
  }
}

// Slopes from one cell to the next are mostly noise, and noise would pass for structure: a plane through 7 x 7 cells instead. NaN
// at an edge and beside a cell without depth.
void fit_slopes(const Thumbnail& view, const std::vector<float>& inverse, std::vector<Eigen::Vector2f>* slopes) {
  constexpr int kRadius = 3;
  constexpr float kSumOfSquares = 7 * (9 + 4 + 1 + 0 + 1 + 4 + 9);
  slopes->assign(view.depth.size(), Eigen::Vector2f::Constant(std::numeric_limits<float>::quiet_NaN()));
  for (int y = kRadius; y < view.height - kRadius; ++y) {
    for (int x = kRadius; x < view.width - kRadius; ++x) {
      Eigen::Vector2f sum = Eigen::Vector2f::Zero();
      std::uint16_t nearest = std::numeric_limits<std::uint16_t>::max(), farthest = 0;
      for (int dy = -kRadius; dy <= kRadius; ++dy) {
        for (int dx = -kRadius; dx <= kRadius; ++dx) {
          const std::uint16_t depth = view.depth[view.index(x + dx, y + dy)];
          nearest = std::min(nearest, depth);
          farthest = std::max(farthest, depth);
          sum += inverse[view.index(x + dx, y + dy)] * Eigen::Vector2f(static_cast<float>(dx), static_cast<float>(dy));
        }
      }
      if (nearest > 0 && farthest - nearest <= kMaxDepthStepShare * 7 * nearest) (*slopes)[view.index(x, y)] = sum / kSumOfSquares;
    }
  }
}

void invert_depth(const Thumbnail& view, std::vector<float>* inverse) {
  inverse->resize(view.depth.size());
  for (std::size_t i = 0; i < view.depth.size(); ++i)
    (*inverse)[i] = view.depth[i] == 0 ? 0 : 1 / (Thumbnail::kDepthUnitM * static_cast<float>(view.depth[i]));
}

std::optional<Surroundings> look(const Thumbnail& view, const std::vector<float>& grey, const std::vector<float>& inverse,
                                 const std::vector<Eigen::Vector2f>& slopes, double x, double y) {
  const double column = std::floor(x), row = std::floor(y);
  if (!(column >= 0 && row >= 0 && column < view.width - 1 && row < view.height - 1)) return std::nullopt;
  const std::size_t i = view.index(static_cast<int>(column), static_cast<int>(row));
  const auto stride = static_cast<std::size_t>(view.width);
  const std::size_t at[4] = {i, i + 1, i + stride, i + stride + 1};
  const auto [nearest, farthest] = std::minmax({view.depth[at[0]], view.depth[at[1]], view.depth[at[2]], view.depth[at[3]]});
  if (nearest == 0 || farthest - nearest > kMaxDepthStepShare * nearest) return std::nullopt;
  const double a = x - column, b = y - row;
  const Eigen::Vector2f& slope = slopes[at[(a < 0.5 ? 0 : 1) + (b < 0.5 ? 0 : 2)]];
  if (!slope.allFinite()) return std::nullopt;
  const auto mix = [&](const auto& v) { return (1 - b) * ((1 - a) * v[at[0]] + a * v[at[1]]) + b * ((1 - a) * v[at[2]] + a * v[at[3]]); };
  Surroundings s{};
  s.grey = mix(grey);
  s.grey_x = (1 - b) * static_cast<double>(grey[at[1]] - grey[at[0]]) + b * static_cast<double>(grey[at[3]] - grey[at[2]]);
  s.grey_y = (1 - a) * static_cast<double>(grey[at[2]] - grey[at[0]]) + a * static_cast<double>(grey[at[3]] - grey[at[1]]);
  s.inverse = mix(inverse);
  s.inverse_x = static_cast<double>(slope.x());
  s.inverse_y = static_cast<double>(slope.y());
  return s;
}

// A slope that noise alone may have made says nothing about the motion.
double share_of_signal(double slope_squared, double noise_squared) {
  return slope_squared > noise_squared ? 1 - noise_squared / slope_squared : 0;
}

double huber_weight(double residual_sigmas) {
  const double size = std::abs(residual_sigmas);
  return size <= kKernelSigmas ? 1.0 : kKernelSigmas / size;
}

/// The change in the axes of b, metres then radians, that leads from the prediction to T_a_b.
Vector6d change_from(const Rigid3& T_a_b_predicted, const Rigid3& T_a_b) {
  const Rigid3 T = T_a_b_predicted.inverse() * T_a_b;
  Vector6d change;
  change << T.translation, log_so3(T.rotation);
  return change;
}

}  // namespace

void DenseAligner::prepare(const Thumbnail& b) {
  points_.clear();
  remove_slow_changes(b, &grey_b_);
  for (int y = 0; y < b.height; ++y) {
    for (int x = 0; x < b.width; ++x) {
      const std::size_t i = b.index(x, y);
      if (b.depth[i] == 0) continue;
      const Eigen::Vector2d ray = camera_.color.undistort({(x + 0.5) * b.cell_px - 0.5, (y + 0.5) * b.cell_px - 0.5});
      const double z = b.depth[i] * static_cast<double>(Thumbnail::kDepthUnitM);
      points_.push_back({z * ray.homogeneous(), grey_b_[i]});
    }
  }
}

DenseAligner::Equations DenseAligner::linearize(const Thumbnail& a, const Thumbnail& b, const Rigid3& T_a_b) {
  pairs_.clear();
  const Eigen::Matrix3d R = T_a_b.rotation.toRotationMatrix();
  const double fx = camera_.color.fx / b.cell_px, fy = camera_.color.fy / b.cell_px;
  double grey_mean = 0;
  for (const Point& point : points_) {
    const Eigen::Vector3d p = R * point.p_b + T_a_b.translation;
    if (p.z() < 0.1 || std::abs(p.x()) > 3 * p.z() || std::abs(p.y()) > 3 * p.z()) continue;
    const Eigen::Vector2d pixel = camera_.color.project(p);
    const Eigen::Vector2d cell = (pixel.array() + 0.5) / a.cell_px - 0.5;
    const auto seen = look(a, grey_a_, inverse_a_, slopes_a_, cell.x(), cell.y());
    if (!seen) continue;
    Eigen::Matrix<double, 3, 6> dp;  // R [I, -[p_b]x]
    dp.leftCols<3>() = R;
    for (int k = 0; k < 3; ++k) dp.col(3 + k) = R * Eigen::Vector3d::Unit(k).cross(point.p_b);
    const Vector6d du = (fx / p.z() * (dp.row(0) - p.x() / p.z() * dp.row(2))).transpose();
    const Vector6d dv = (fy / p.z() * (dp.row(1) - p.y() / p.z() * dp.row(2))).transpose();
    Pair& pair = pairs_.emplace_back();
    pair.grey = seen->grey - point.grey;
    const double inverse = 1 / p.z();
    pair.depth = seen->inverse - inverse;
    pair.depth_sigma = inverse * inverse * (kDepthSigmaShare * camera_.depth_noise.sigma_m(p.z()) + kDepthSigmaM);
    pair.slope_squared = seen->grey_x * seen->grey_x + seen->grey_y * seen->grey_y;
    pair.J_grey = seen->grey_x * du + seen->grey_y * dv;
    pair.J_depth = seen->inverse_x * du + seen->inverse_y * dv + inverse * inverse * dp.row(2).transpose();
    grey_mean += pair.grey;
  }
  Equations equations;
  if (pairs_.empty()) return equations;
  grey_mean /= static_cast<double>(pairs_.size());  // the exposure may change
  std::vector<double> sizes;
  sizes.reserve(pairs_.size());
  for (const Pair& pair : pairs_) sizes.push_back(std::abs(pair.grey - grey_mean));
  const double measured_sigma = 1.48 * upper_median(std::move(sizes)), grey_sigma = std::max(measured_sigma, kMinGreySigma);
  const double noise_slope = kSlopeNoise * measured_sigma * measured_sigma;
  std::size_t num_inliers = 0;
  for (const Pair& pair : pairs_) {
    const double grey = (pair.grey - grey_mean) / grey_sigma, depth = pair.depth / pair.depth_sigma;
    if (std::abs(depth) > kDepthInlierSigmas) continue;  // another surface
    ++num_inliers;
    const double grey_weight =
        kIndependentGreyShare * huber_weight(grey) / (grey_sigma * grey_sigma) * share_of_signal(pair.slope_squared, noise_slope);
    const double depth_weight = kIndependentDepthShare * huber_weight(depth) / (pair.depth_sigma * pair.depth_sigma);
    equations.H += grey_weight * pair.J_grey * pair.J_grey.transpose() + depth_weight * pair.J_depth * pair.J_depth.transpose();
    equations.g += grey_weight * (pair.grey - grey_mean) * pair.J_grey + depth_weight * pair.depth * pair.J_depth;
  }
  equations.overlap = static_cast<double>(pairs_.size()) / static_cast<double>(points_.size());
  equations.inlier_share = static_cast<double>(num_inliers) / static_cast<double>(pairs_.size());
  return equations;
}

DenseAlignment DenseAligner::align(const Thumbnail& a, const Thumbnail& b, const Rigid3& T_a_b_predicted, const Matrix6d& covariance) {
  DenseAlignment result;
  if (a.empty() || b.empty()) return result;
  prepare(b);
  remove_slow_changes(a, &grey_a_);
  invert_depth(a, &inverse_a_);
  fit_slopes(a, inverse_a_, &slopes_a_);
  const Matrix6d prior = rotate_covariance(T_a_b_predicted.rotation.conjugate(), covariance).inverse();
  result.T_a_b = T_a_b_predicted;
  Equations equations;
  for (int i = 0; i < kMaxIterations; ++i) {
    equations = linearize(a, b, result.T_a_b);
    if (equations.overlap < kMinOverlap) return result;
    const Matrix6d H = equations.H + prior;
    const Vector6d step = -H.llt().solve(equations.g + prior * change_from(T_a_b_predicted, result.T_a_b));
    if (!step.allFinite()) return result;
    result.T_a_b = moved_in_camera_axes(result.T_a_b, step);
    if (step.norm() < kSettled) break;
  }
  equations = linearize(a, b, result.T_a_b);
  result.overlap = equations.overlap;
  result.inlier_share = equations.inlier_share;
  result.covariance = rotate_covariance(result.T_a_b.rotation, (equations.H + prior).inverse());
  const Vector6d change = change_from(T_a_b_predicted, result.T_a_b);
  result.is_aligned = result.overlap >= kMinOverlap && result.inlier_share >= kMinInlierShare &&
                      change.dot(prior * change) <= kMaxPriorSigmas * kMaxPriorSigmas;
  return result;
}

}  // namespace camloc
