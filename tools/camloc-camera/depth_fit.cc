// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/camloc-camera/depth_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/order_statistics.h"
#include "core/geometry/symmetric_system.h"

namespace camloc::camera_tool {
namespace {

constexpr std::size_t kMinPixels = 200, kMinPlanes = 5;
constexpr double kMaxError = 0.2;          // relative: what is farther off is not the board
constexpr double kMinDepthRange = 1.5;     // farthest over nearest, to tell scale from offset
constexpr double kMinPlaneRange = 1.3;     // the same for planes and the extrinsic
constexpr double kMinNormalSpread = 0.01;  // smallest mean squared component of the normals: about 6 degrees of tilt to both sides
constexpr double kMadToSigma = 1.4826;
constexpr double kStep = 0.01;                       // relative; a Kinect's steps are 0.3 % of the distance at 1 m, 1 % at 4 m
constexpr double kWiderMargin = 1.0, kMargin = 0.3;  // squares within the outermost corners

/// One pixel of depth on the board.
struct Sample {
  Eigen::Vector3d ray;  // (x/z, y/z, 1)
  double inverse_z;
};

struct Rectangle {
  double left, top, right, bottom;
  [[nodiscard]] bool holds(const Eigen::Vector3d& p) const { return p.x() > left && p.x() < right && p.y() > top && p.y() < bottom; }
};

Rectangle inner_rectangle(const Board& board, double margin_squares) {
  const Eigen::Vector2d first = board.corner_m(0), last = board.corner_m(board.num_corners() - 1);
  const double margin_m = margin_squares * board.square_m;
  return {first.x() + margin_m, first.y() + margin_m, last.x() - margin_m, last.y() - margin_m};
}

/// z along each ray of the plane z = 0 of the board, or nothing where the ray misses the rectangle.
struct BoardInDepth {
  Rigid3 T_board_depth;
  Rectangle rectangle;

  [[nodiscard]] std::optional<double> z_at(const Eigen::Vector3d& ray) const {
    const Eigen::Vector3d direction = T_board_depth.rotation * ray;
    const double z = -T_board_depth.translation.z() / direction.z();
    if (!(z > 0) || !rectangle.holds(T_board_depth.translation + z * direction)) return std::nullopt;
    return z;
  }
};

std::vector<Sample> samples_on(const BoardInDepth& board, const Image<std::uint16_t>& depth, const RgbdCamera& camera,
                               const UndistortionTable& rays) {
  std::vector<Sample> samples;
  for (int y = 0; y < depth.height; ++y) {
    for (int x = 0; x < depth.width; ++x) {
      const double z = camera.depth_m(depth.at(x, y));
      if (z <= 0) continue;
      const Eigen::Vector3d ray = rays.undistort(static_cast<float>(x), static_cast<float>(y)).cast<double>().homogeneous();
      const std::optional<double> true_z = board.z_at(ray);
      if (true_z && std::abs(z / *true_z - 1) < kMaxError) samples.push_back({ray, 1 / z});
    }
  }
  return samples;
}

Eigen::Vector3d mean_ray(const std::vector<Sample>& samples) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Sample& sample : samples) sum += sample.ray;
  return sum / static_cast<double>(samples.size());
}

Eigen::Vector3d least_squares_plane(const std::vector<Sample>& samples) {
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  for (const Sample& sample : samples) {
    A += sample.ray * sample.ray.transpose();
    b += sample.inverse_z * sample.ray;
  }
  return solve_symmetric<3>(A, b);
}

/// Least squares, three times, without what is far off.
std::optional<DepthPlane> fit_plane(std::vector<Sample> samples, const BoardInDepth& board) {
  DepthPlane plane;
  for (int round = 0; round < 3; ++round) {
    if (samples.size() < kMinPixels) return std::nullopt;
    plane.inverse = least_squares_plane(samples);
    const auto error = [&plane](const Sample& sample) { return std::abs(plane.inverse.dot(sample.ray) - sample.inverse_z); };
    std::vector<double> errors;
    for (const Sample& sample : samples) errors.push_back(error(sample));
    // Readings come in steps: where most are equal, the median says nothing, and one step is no outlier.
    const double tolerance = std::max(3 * kMadToSigma * upper_median(std::move(errors)), kStep * plane.inverse.dot(mean_ray(samples)));
    std::erase_if(samples, [&](const Sample& sample) { return error(sample) > tolerance; });
  }
  if (samples.size() < kMinPixels) return std::nullopt;
  const Eigen::Vector3d middle = mean_ray(samples);
  const std::optional<double> true_z_m = board.z_at(middle);
  plane.z_m = 1 / plane.inverse.dot(middle);
  if (!true_z_m || !(plane.z_m > 0)) return std::nullopt;
  plane.true_z_m = *true_z_m;
  double squares = 0;
  for (const Sample& sample : samples) squares += std::pow(plane.inverse.dot(sample.ray) - sample.inverse_z, 2);
  plane.noise_m = std::sqrt(squares / static_cast<double>(samples.size())) * plane.z_m * plane.z_m;
  plane.num_pixels = samples.size();
  return plane;
}

std::vector<DepthPlane> see_planes(const Board& board, std::span<const BoardView> views, std::span<const Rigid3> T_color_board,
                                   const RgbdCamera& camera, double margin_squares) {
  const UndistortionTable rays(camera.depth);
  std::vector<DepthPlane> seen;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (views[i].depth.width != camera.depth.width || views[i].depth.height != camera.depth.height) continue;
    const BoardInDepth in_depth{T_color_board[i].inverse() * camera.T_color_depth, inner_rectangle(board, margin_squares)};
    const std::optional<DepthPlane> plane = fit_plane(samples_on(in_depth, views[i].depth, camera, rays), in_depth);
    if (plane) seen.emplace_back(*plane).view = i;
  }
  return seen;
}

/// Weighted least squares of z = scale * true z + offset; the weights fall as a structured-light camera's noise grows.
void fit_line(DepthFit* fit) {
  Eigen::Matrix2d A = Eigen::Matrix2d::Zero();
  Eigen::Vector2d b = Eigen::Vector2d::Zero();
  const auto weight = [](const DepthPlane& plane) { return std::pow(DepthNoise{}.sigma_m(plane.true_z_m), -2); };
  for (const DepthPlane& plane : fit->planes) {
    const Eigen::Vector2d row(plane.true_z_m, fit->has_offset ? 1 : 0);
    A += weight(plane) * row * row.transpose();
    b += weight(plane) * plane.z_m * row;
  }
  if (!fit->has_offset) A(1, 1) = 1;
  const Eigen::Vector2d solution = solve_symmetric<2>(A, b);
  double chi2 = 0;
  for (const DepthPlane& plane : fit->planes) chi2 += weight(plane) * std::pow(plane.z_m - solution[0] * plane.true_z_m - solution[1], 2);
  const double num_free = static_cast<double>(fit->planes.size()) - (fit->has_offset ? 2 : 1);
  const Eigen::Matrix2d covariance = A.inverse() * (chi2 / num_free);
  fit->scale = solution[0];
  fit->scale_sigma = std::sqrt(covariance(0, 0));
  if (!fit->has_offset) return;
  fit->offset_m = solution[1];
  fit->offset_sigma_m = std::sqrt(covariance(1, 1));
}

/// sigma(z) = constant + quadratic z^2 through the scatter of all planes, neither part negative.
DepthNoise fit_noise(const std::vector<DepthPlane>& planes) {
  Eigen::Matrix2d A = Eigen::Matrix2d::Zero();
  Eigen::Vector2d b = Eigen::Vector2d::Zero();
  for (const DepthPlane& plane : planes) {
    // Relative errors count alike, near and far.
    const Eigen::Vector2d row = Eigen::Vector2d(1, plane.z_m * plane.z_m) / std::max(plane.noise_m, 1e-5);
    A += row * row.transpose();
    b += row * (plane.noise_m / std::max(plane.noise_m, 1e-5));
  }
  Eigen::Vector2d solution = solve_symmetric<2>(A, b);
  if (solution[0] < 0 || !solution.allFinite()) solution = {0, b[1] / A(1, 1)};
  if (solution[1] < 0) solution = {b[0] / A(0, 0), 0};
  return {solution[0], solution[1]};
}

double largest_sigma(const Eigen::Matrix3d& covariance) {
  return std::sqrt(
      std::max(0.0, Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff()));
}

/// A plane in both cameras: n . p = distance, the normals turned away from the camera.
struct PlanePair {
  Eigen::Vector3d color_normal, depth_normal;
  double color_distance_m, depth_distance_m;
};

PlanePair pair_up(const DepthPlane& seen, const Rigid3& T_color_board) {
  PlanePair pair;
  pair.depth_distance_m = 1 / seen.inverse.norm();
  pair.depth_normal = seen.inverse * pair.depth_distance_m;
  pair.color_normal = T_color_board.rotation * Eigen::Vector3d::UnitZ();
  pair.color_distance_m = pair.color_normal.dot(T_color_board.translation);
  if (pair.color_distance_m < 0) {
    pair.color_normal = -pair.color_normal;
    pair.color_distance_m = -pair.color_distance_m;
  }
  return pair;
}

/// From color_distance = depth_distance / scale + color_normal . translation. The scale is left at 1 where the board was always at
/// about the same distance, because it cannot be told from the translation then.
void solve_translation(const std::vector<PlanePair>& pairs, ExtrinsicFit* fit) {
  const auto [nearest, farthest] = std::minmax_element(
      pairs.begin(), pairs.end(), [](const PlanePair& a, const PlanePair& b) { return a.depth_distance_m < b.depth_distance_m; });
  const bool has_scale = farthest->depth_distance_m > kMinPlaneRange * nearest->depth_distance_m;
  Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
  Eigen::Vector4d b = Eigen::Vector4d::Zero();
  for (const PlanePair& pair : pairs) {
    Eigen::Vector4d row;
    row << pair.color_normal, has_scale ? pair.depth_distance_m : 0;
    A += row * row.transpose();
    b += (pair.color_distance_m - pair.depth_distance_m) * row;
  }
  if (!has_scale) A(3, 3) = 1;
  const Eigen::Vector4d solution = solve_symmetric<4>(A, b);
  double squares = 0;
  for (const PlanePair& pair : pairs) {
    squares += std::pow(pair.color_distance_m - (1 + solution[3]) * pair.depth_distance_m - pair.color_normal.dot(solution.head<3>()), 2);
  }
  const auto count = static_cast<double>(pairs.size());
  fit->T_color_depth.translation = solution.head<3>();
  fit->depth_scale = 1 / (1 + solution[3]);
  fit->distance_rms_m = std::sqrt(squares / count);
  fit->translation_sigma_m = largest_sigma(A.inverse().topLeftCorner<3, 3>() * (squares / (count - 4)));
}

Result<ExtrinsicFit> solve_planes(const std::vector<PlanePair>& pairs) {
  Eigen::Matrix3d cross = Eigen::Matrix3d::Zero(), spread = Eigen::Matrix3d::Zero(), turn = Eigen::Matrix3d::Zero();
  for (const PlanePair& pair : pairs) {
    cross += pair.color_normal * pair.depth_normal.transpose();
    spread += pair.color_normal * pair.color_normal.transpose();
    turn += Eigen::Matrix3d::Identity() - pair.color_normal * pair.color_normal.transpose();
  }
  const auto count = static_cast<double>(pairs.size());
  if (Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread / count, Eigen::EigenvaluesOnly).eigenvalues()[0] < kMinNormalSpread) {
    return {ErrorCode::kInvalid,
            "the board was never tilted enough to both sides to tell where the depth camera is; tilt it left, right, up and down"};
  }
  ExtrinsicFit fit;
  fit.T_color_depth.rotation = nearest_rotation(cross);
  solve_translation(pairs, &fit);
  double squares = 0;
  for (const PlanePair& pair : pairs) squares += (pair.color_normal - fit.T_color_depth.rotation * pair.depth_normal).squaredNorm();
  fit.normal_rms_rad = std::sqrt(squares / count);
  fit.rotation_sigma_rad = largest_sigma(turn.inverse() * (squares / (2 * count - 3)));
  return fit;
}

Status too_few_planes(std::size_t count) {
  return {ErrorCode::kInvalid, std::to_string(count) + " depth images show the board, " + std::to_string(kMinPlanes) +
                                   " are needed; show it between 0.5 and 3 m, where the depth camera sees it"};
}

}  // namespace

Result<DepthFit> fit_depth(const Board& board, std::span<const BoardView> views, std::span<const Rigid3> T_color_board,
                           const RgbdCamera& camera) {
  DepthFit fit;
  fit.planes = see_planes(board, views, T_color_board, camera, kMargin);
  if (fit.planes.size() < kMinPlanes) return too_few_planes(fit.planes.size());
  const auto by_distance = [](const DepthPlane& a, const DepthPlane& b) { return a.true_z_m < b.true_z_m; };
  std::sort(fit.planes.begin(), fit.planes.end(), by_distance);
  fit.near_m = fit.planes.front().true_z_m;
  fit.far_m = fit.planes.back().true_z_m;
  fit.has_offset = camera.is_depth_registered && fit.far_m > kMinDepthRange * fit.near_m;  // else the extrinsic has taken it up
  fit_line(&fit);
  fit.noise = fit_noise(fit.planes);
  return fit;
}

Result<ExtrinsicFit> fit_extrinsic(const Board& board, std::span<const BoardView> views, std::span<const Rigid3> T_color_board,
                                   const RgbdCamera& camera) {
  RgbdCamera guess = camera;
  Result<ExtrinsicFit> fit = too_few_planes(0);
  for (int round = 0; round < 4; ++round) {
    std::vector<PlanePair> pairs;
    for (const DepthPlane& seen : see_planes(board, views, T_color_board, guess, round == 0 ? kWiderMargin : kMargin)) {
      pairs.push_back(pair_up(seen, T_color_board[seen.view]));
    }
    if (pairs.size() < kMinPlanes) return too_few_planes(pairs.size());
    fit = solve_planes(pairs);
    if (!fit) return fit;
    guess.T_color_depth = fit->T_color_depth;
  }
  return fit;
}

}  // namespace camloc::camera_tool
