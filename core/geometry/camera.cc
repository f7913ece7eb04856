// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/camera.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

namespace camloc {
namespace {

constexpr int kMaxImageSize = 16384;
constexpr int kMaxNewtonSteps = 10;

using Coefficients = std::array<double, 8>;

/// Distorted normalized coordinates and their Jacobian by the undistorted ones.
struct Distorted {
  Eigen::Vector2d point;
  Eigen::Matrix2d jacobian;
};

/// `radial_by_r2` is the derivative of the radial factor by r^2.
Distorted radial_and_tangential(double p1, double p2, const Eigen::Vector2d& n, double radial, double radial_by_r2) {
  const double x = n.x(), y = n.y(), r2 = x * x + y * y;
  Distorted d;
  d.point.x() = x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x);
  d.point.y() = y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y;
  d.jacobian(0, 0) = radial + 2.0 * x * x * radial_by_r2 + 2.0 * p1 * y + 6.0 * p2 * x;
  d.jacobian(0, 1) = 2.0 * x * y * radial_by_r2 + 2.0 * p1 * x + 2.0 * p2 * y;
  d.jacobian(1, 0) = d.jacobian(0, 1);
  d.jacobian(1, 1) = radial + 2.0 * y * y * radial_by_r2 + 6.0 * p1 * y + 2.0 * p2 * x;
  return d;
}

Distorted distort_brown_conrady(const Coefficients& k, const Eigen::Vector2d& n) {
  const double k1 = k[0], k2 = k[1], k3 = k[4];
  const double r2 = n.x() * n.x() + n.y() * n.y();
  const double radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double radial_by_r2 = k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3);
  return radial_and_tangential(k[2], k[3], n, radial, radial_by_r2);
}

Distorted distort_rational(const Coefficients& k, const Eigen::Vector2d& n) {
  const double k1 = k[0], k2 = k[1], k3 = k[4], k4 = k[5], k5 = k[6], k6 = k[7];
  const double r2 = n.x() * n.x() + n.y() * n.y();
  const double above = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3)), below = 1.0 + r2 * (k4 + r2 * (k5 + r2 * k6));
  const double above_by_r2 = k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3), below_by_r2 = k4 + r2 * (2.0 * k5 + r2 * 3.0 * k6);
  const double radial = above / below;
  const double radial_by_r2 = (above_by_r2 - radial * below_by_r2) / below;
  return radial_and_tangential(k[2], k[3], n, radial, radial_by_r2);
}

double equidistant_angle(const Coefficients& k, double theta) {
  const double t2 = theta * theta;
  return theta * (1.0 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))));
}

double equidistant_angle_derivative(const Coefficients& k, double theta) {
  const double t2 = theta * theta;
  return 1.0 + t2 * (3.0 * k[0] + t2 * (5.0 * k[1] + t2 * (7.0 * k[2] + t2 * 9.0 * k[3])));
}

Eigen::Vector2d distort_equidistant(const Coefficients& k, const Eigen::Vector2d& n) {
  const double r = n.norm();
  if (r < 1e-12) return n;
  return equidistant_angle(k, std::atan(r)) / r * n;
}

/// Newton with step halving: each accepted step comes nearer to `target`, so the result is never worse than the start.
template <typename Distort>
Eigen::Vector2d undistort_polynomial(const Distort& distort_at, const Coefficients& k, const Eigen::Vector2d& target) {
  Eigen::Vector2d n = target;
  Distorted d = distort_at(k, n);
  for (int step = 0; step < kMaxNewtonSteps; ++step) {
    const Eigen::Vector2d residual = d.point - target;
    const double determinant = d.jacobian.determinant();
    if (residual.squaredNorm() < 1e-24) break;
    // Beyond the fold of the model the Newton step would lead onto the wrong branch: go back along the residual there.
    Eigen::Vector2d change = -residual;
    if (determinant > 1e-3) change = -(d.jacobian.inverse() * residual);
    bool is_better = false;
    for (double fraction = 1.0; fraction > 0.02 && !is_better; fraction *= 0.5) {
      const Eigen::Vector2d candidate = n + fraction * change;
      const Distorted at_candidate = distort_at(k, candidate);
      is_better = (at_candidate.point - target).squaredNorm() < residual.squaredNorm();
      if (is_better) {
        n = candidate;
        d = at_candidate;
      }
    }
    if (!is_better) break;
  }
  return n;
}

/// The angle whose distorted value is `target`, by Newton on the angle, kept below a right angle.
double undistort_equidistant_angle(const Coefficients& k, double target) {
  constexpr double kMaxAngle = 0.5 * std::numbers::pi - 1e-3;
  double theta = std::clamp(target, 0.0, kMaxAngle);
  for (int step = 0; step < kMaxNewtonSteps; ++step) {
    const double slope = std::max(equidistant_angle_derivative(k, theta), 0.1);
    const double change = (target - equidistant_angle(k, theta)) / slope;
    theta = std::clamp(theta + change, 0.0, kMaxAngle);
    if (std::abs(change) < 1e-13) break;
  }
  return theta;
}

bool is_slope_positive_up_to(const Intrinsics& camera, const Eigen::Vector2d& normalized) {
  // The model is invertible on the branch through the centre as long as no fold lies between.
  constexpr int kSteps = 32;
  for (int i = 1; i <= kSteps; ++i) {
    const Eigen::Vector2d n = static_cast<double>(i) / kSteps * normalized;
    if (camera.lens != LensModel::kEquidistant) {
      const bool is_rational = camera.lens == LensModel::kRational;
      const Eigen::Matrix2d jacobian = (is_rational ? distort_rational : distort_brown_conrady)(camera.distortion, n).jacobian;
      if (jacobian.determinant() <= 0.0 || jacobian.trace() <= 0.0) return false;
    } else if (equidistant_angle_derivative(camera.distortion, std::atan(n.norm())) <= 0.0) {
      return false;
    }
  }
  return true;
}

template <typename T>
Status out_of_range(const char* key, T value, const char* allowed) {
  std::ostringstream message;
  message << key << " = " << value << " is not allowed: " << allowed;
  return {ErrorCode::kInvalid, message.str()};
}

}  // namespace

Status Intrinsics::validate() const {
  if (width < 1 || width > kMaxImageSize) return out_of_range("width", width, "1 to 16384 pixels");
  if (height < 1 || height > kMaxImageSize) return out_of_range("height", height, "1 to 16384 pixels");
  const double max_focal = 100.0 * std::max(width, height);
  if (!(fx > 0.0 && fx <= max_focal)) return out_of_range("fx", fx, "positive, at most 100 times the longer image side");
  if (fy < 0.0) {
    return out_of_range("fy", fy,
                        "positive. With y upwards, as ICL-NUIM has it, the images are the same: write fy without the sign, and mirror "
                        "given poses (or build without them)");
  }
  if (!(fy > 0.0 && fy <= max_focal)) return out_of_range("fy", fy, "positive, at most 100 times the longer image side");
  if (!(cx > -width && cx < 2.0 * width)) return out_of_range("cx", cx, "at most one image width outside the image");
  if (!(cy > -height && cy < 2.0 * height)) return out_of_range("cy", cy, "at most one image height outside the image");
  if (lens > LensModel::kRational) return out_of_range("lens", static_cast<int>(lens), "0, 1, 2 or 3");
  for (const double k : distortion) {
    if (!(std::abs(k) <= 1000.0)) return out_of_range("distortion", k, "finite, magnitude at most 1000");
  }
  return Status::ok();
}

Eigen::Vector2d Intrinsics::project(const Eigen::Vector3d& p_camera) const { return distort(p_camera.head<2>() / p_camera.z()); }

Eigen::Vector2d Intrinsics::distort(const Eigen::Vector2d& normalized) const {
  Eigen::Vector2d d = normalized;
  if (lens == LensModel::kBrownConrady) d = distort_brown_conrady(distortion, normalized).point;
  if (lens == LensModel::kRational) d = distort_rational(distortion, normalized).point;
  if (lens == LensModel::kEquidistant) d = distort_equidistant(distortion, normalized);
  return {fx * d.x() + cx, fy * d.y() + cy};
}

Eigen::Vector2d Intrinsics::undistort(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d target((pixel.x() - cx) / fx, (pixel.y() - cy) / fy);
  if (lens == LensModel::kBrownConrady) return undistort_polynomial(distort_brown_conrady, distortion, target);
  if (lens == LensModel::kRational) return undistort_polynomial(distort_rational, distortion, target);
  if (lens == LensModel::kEquidistant) {
    const double r = target.norm();
    if (r < 1e-12) return target;
    return std::tan(undistort_equidistant_angle(distortion, r)) / r * target;
  }
  return target;
}

bool Intrinsics::is_invertible_at(const Eigen::Vector2d& pixel) const {
  if (lens == LensModel::kPinhole) return true;
  const Eigen::Vector2d normalized = undistort(pixel);
  constexpr double kMaxError = 1e-3;  // px: the iteration has converged, not merely come near
  return (distort(normalized) - pixel).norm() < kMaxError && is_slope_positive_up_to(*this, normalized);
}

Status RgbdCamera::validate() const {
  if (Status status = color.validate(); !status) return status.with_context("color");
  if (Status status = depth.validate(); !status) return status.with_context("depth");
  if (is_depth_registered && (depth.width != color.width || depth.height != color.height)) {
    return {ErrorCode::kInvalid, "is_depth_registered = true is not allowed: colour and depth image differ in size"};
  }
  const double norm = T_color_depth.rotation.norm();
  if (!(std::abs(norm - 1.0) < 1e-3)) return out_of_range("T_color_depth rotation norm", norm, "1, a unit quaternion");
  const double baseline_m = T_color_depth.translation.norm();
  if (!(baseline_m <= 1.0)) return out_of_range("T_color_depth translation", baseline_m, "at most 1 m");
  if (!(depth_unit_m > 0.0 && depth_unit_m <= 0.1)) return out_of_range("depth_unit_m", depth_unit_m, "above 0, at most 0.1 m");
  if (!(min_depth_m >= 0.0)) return out_of_range("min_depth_m", min_depth_m, "0 m or more");
  if (!(max_depth_m > min_depth_m && max_depth_m <= 1000.0)) {
    return out_of_range("max_depth_m", max_depth_m, "above min_depth_m, at most 1000 m");
  }
  if (!(depth_noise.constant_m >= 0.0 && depth_noise.constant_m <= 1.0)) {
    return out_of_range("depth_noise.constant_m", depth_noise.constant_m, "0 to 1 m");
  }
  if (!(depth_noise.quadratic_per_m >= 0.0 && depth_noise.quadratic_per_m <= 1.0)) {
    return out_of_range("depth_noise.quadratic_per_m", depth_noise.quadratic_per_m, "0 to 1 per metre");
  }
  if (!(depth_noise.sigma_m(1.0) > 0.0)) return out_of_range("depth_noise", 0.0, "one of its two terms above 0");
  return Status::ok();
}

UndistortionTable::UndistortionTable(const Intrinsics& intrinsics, int step_px) : inverse_step_(1.0F / static_cast<float>(step_px)) {
  // Two nodes at least in each direction, so that every pixel has a cell.
  columns_ = std::max(intrinsics.width - 1 + step_px - 1, step_px) / step_px + 1;
  rows_ = std::max(intrinsics.height - 1 + step_px - 1, step_px) / step_px + 1;
  nodes_.reserve(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      nodes_.push_back(intrinsics.undistort(Eigen::Vector2d(column * step_px, row * step_px)).cast<float>());
    }
  }
}

Eigen::Vector2f UndistortionTable::undistort(float u, float v) const {
  // Outside the image the border cell is continued linearly.
  const float column = u * inverse_step_, row = v * inverse_step_;
  const int i = static_cast<int>(std::clamp(column, 0.0F, static_cast<float>(columns_ - 2)));
  const int j = static_cast<int>(std::clamp(row, 0.0F, static_cast<float>(rows_ - 2)));
  const float a = column - static_cast<float>(i), b = row - static_cast<float>(j);
  const Eigen::Vector2f* node = nodes_.data() + static_cast<std::ptrdiff_t>(j) * columns_ + i;
  const Eigen::Vector2f upper = node[0] + a * (node[1] - node[0]);
  const Eigen::Vector2f lower = node[columns_] + a * (node[columns_ + 1] - node[columns_]);
  return upper + b * (lower - upper);
}

}  // namespace camloc
