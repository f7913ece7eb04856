// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The robust loop: sample, solve, score, polish; always the same number of times.
#include "core/geometry/pnp_ransac.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/geometry/p3p.h"
#include "core/geometry/pose_jacobian.h"
#include "core/geometry/symmetric_system.h"

namespace camloc {
namespace {

constexpr int kMaxRedraws = 8;
constexpr int kPolishSteps = 3;
constexpr std::size_t kMaxPolishInliers = 256;  // more do not make a hypothesis better, only slower
constexpr std::size_t kMinPolishInliers = 5;

using Sample = std::array<std::size_t, 3>;

/// PCG32 (O'Neill, "PCG: a family of simple fast space-efficient statistically good algorithms", 2014).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed * 0x9E3779B97F4A7C15ULL + 0xD1B54A32D192ED03ULL) { next(); }

  std::uint32_t next() {
    const std::uint64_t old = state_;
    state_ = old * 6364136223846793005ULL + 1442695040888963407ULL;
    const auto xorshifted = static_cast<std::uint32_t>(((old >> 18U) ^ old) >> 27U);
    const auto turn = static_cast<std::uint32_t>(old >> 59U);
    return (xorshifted >> turn) | (xorshifted << ((32U - turn) & 31U));
  }
  /// In [0, size), by multiplication: the bias is below size / 2^32.
  std::size_t below(std::size_t size) { return static_cast<std::size_t>((std::uint64_t{next()} * size) >> 32U); }

 private:
  std::uint64_t state_;
};

/// Three different indices below `size` >= 3.
Sample draw(std::size_t size, Random* random) {
  Sample sample;
  sample[0] = random->below(size);
  sample[1] = random->below(size - 1);
  sample[2] = random->below(size - 2);
  if (sample[1] >= sample[0]) ++sample[1];
  const auto [low, high] = std::minmax(sample[0], sample[1]);
  if (sample[2] >= low) ++sample[2];
  if (sample[2] >= high) ++sample[2];
  return sample;
}

/// n(k) of the header, at least `pool`, which is that of a sample before.
std::size_t grown_pool(std::size_t pool, std::size_t num_pairs, std::uint64_t sample, std::uint64_t num_samples) {
  const auto triples = [](std::uint64_t n) { return n * (n - 1) * (n - 2) / 6; };
  while (pool < num_pairs && triples(pool) * num_samples < (sample + 1) * triples(num_pairs)) ++pool;
  return pool;
}

Eigen::Vector3d ray(const PoseScorer& pairs, std::size_t i) {
  const Eigen::Vector2d p = pairs.image_point(i);
  return {p.x(), p.y(), 1.0};
}

/// False where depth proves that not all three pairs are right.
bool is_consistent_with_depth(const PoseScorer& pairs, const Sample& sample, float max_relative_depth_error) {
  const auto [i, j, k] = sample;
  if (!(pairs.has_depth(i) & pairs.has_depth(j) & pairs.has_depth(k))) return true;
  // All three at once: which one fails cannot be predicted.
  return pairs.is_distance_consistent(i, j, max_relative_depth_error) & pairs.is_distance_consistent(j, k, max_relative_depth_error) &
         pairs.is_distance_consistent(k, i, max_relative_depth_error);
}

ScoredPose scored_pose(const Eigen::Matrix3d& R_camera_map, const Eigen::Vector3d& t_camera_map) {
  ScoredPose pose;
  Eigen::Map<Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(pose.R) = R_camera_map.cast<float>();
  Eigen::Map<Eigen::Vector3f>(pose.t) = t_camera_map.cast<float>();
  return pose;
}

ScoredPose scored_pose(const Rigid3& T_map_camera) {
  const Rigid3 T_camera_map = T_map_camera.inverse();
  return scored_pose(T_camera_map.rotation.toRotationMatrix(), T_camera_map.translation);
}

/// Best pose so far, in the shifted frame of the scorer.
struct Best {
  Rigid3 T_map_camera;
  float cost = std::numeric_limits<float>::infinity();
};

/// One Gauss-Newton step on the reprojection error of the inliers of `pose`. False when there are too few.
bool gauss_newton_step(const PoseScorer& pairs, std::size_t max_inliers, Rigid3* T_map_camera) {
  const Rigid3 T_camera_map = T_map_camera->inverse();
  const Eigen::Matrix3d R = T_camera_map.rotation.toRotationMatrix();
  const ScoredPose pose = scored_pose(R, T_camera_map.translation);
  ReprojectionSums<double> sums;
  std::size_t num_inliers = 0;
  for (std::size_t i = 0; i < pairs.size() && num_inliers < max_inliers; ++i) {
    if (!pairs.pair_cost(pose, i).is_inlier) continue;
    ++num_inliers;
    const Eigen::Vector3d p = R * pairs.landmark(i) + T_camera_map.translation;
    const double inverse_z = 1.0 / p.z(), u = p.x() * inverse_z, v = p.y() * inverse_z;
    const Eigen::Vector2d measured = pairs.image_point(i);
    sums.add(u, v, inverse_z, u - measured.x(), v - measured.y(), 1.0, 1.0);
  }
  if (num_inliers < kMinPolishInliers) return false;
  Matrix6d hessian = hessian_of(sums);
  hessian.diagonal() *= 1.0 + 1e-6;  // keeps a flat direction from running away
  const Vector6d change = -solve_symmetric<6>(hessian, gradient_of(sums));
  if (!change.allFinite()) return false;
  *T_map_camera = moved_in_camera_axes(*T_map_camera, change);
  return true;
}

/// Local optimization: keeps the polished pose only where it scores better.
void polish(const PoseScorer& pairs, std::size_t max_inliers, Best* best) {
  Rigid3 T_map_camera = best->T_map_camera;
  for (int step = 0; step < kPolishSteps; ++step) {
    if (!gauss_newton_step(pairs, max_inliers, &T_map_camera)) return;
  }
  const float cost = pairs.cost(scored_pose(T_map_camera), best->cost);
  if (cost < best->cost) *best = {T_map_camera, cost};
}

/// Solves one sample and takes over its best pose if that beats the best so far.
bool try_sample(const PoseScorer& pairs, const Sample& sample, Best* best) {
  std::array<Eigen::Vector3d, 3> bearings, points;
  for (std::size_t k = 0; k < 3; ++k) {
    bearings[k] = ray(pairs, sample[k]).normalized();
    points[k] = pairs.landmark(sample[k]);
  }
  const P3pSolutions solutions = solve_p3p(bearings, points);
  bool is_improved = false;
  for (std::size_t s = 0; s < static_cast<std::size_t>(solutions.count); ++s) {
    const float cost = pairs.cost(scored_pose(solutions.R_camera_map[s], solutions.t_camera_map[s]), best->cost);
    if (!(cost < best->cost)) continue;
    const Eigen::Quaterniond rotation(solutions.R_camera_map[s]);
    *best = {Rigid3{rotation.normalized(), solutions.t_camera_map[s]}.inverse(), cost};
    is_improved = true;
  }
  return is_improved;
}

}  // namespace

PnpRansac::PnpRansac(const PnpRansacOptions& options)
    : options_(options),
      scorer_(static_cast<std::size_t>(std::max(options.max_pairs, 0))),
      inlier_mask_(static_cast<std::size_t>(std::max(options.max_pairs, 0))) {}

PnpRansacResult PnpRansac::estimate(const Correspondences& pairs, double focal_px, std::uint64_t seed) {
  const std::size_t n = std::min(pairs.size(), static_cast<std::size_t>(std::max(options_.max_pairs, 0)));
  inlier_mask_.assign(n, 0);
  PnpRansacResult result;
  if (n < 4) return result;
  scorer_.set_pairs(pairs, n, focal_px, options_.max_error_px, options_.max_relative_depth_error);

  Random random(seed);
  std::size_t pool_size = 4;
  Best best;
  int num_polished = 0;
  const auto max_relative_depth_error = static_cast<float>(options_.max_relative_depth_error);
  for (int iteration = 0; iteration < options_.iterations; ++iteration) {
    pool_size = grown_pool(pool_size, n, static_cast<std::uint64_t>(iteration), static_cast<std::uint64_t>(options_.iterations));
    Sample sample = draw(pool_size, &random);
    for (int redraw = 0; redraw < kMaxRedraws; ++redraw) {
      if (is_consistent_with_depth(scorer_, sample, max_relative_depth_error)) break;
      sample = draw(pool_size, &random);
    }
    if (try_sample(scorer_, sample, &best) && num_polished < options_.local_optimizations) {
      ++num_polished;
      polish(scorer_, kMaxPolishInliers, &best);
    }
  }
  if (!(best.cost < std::numeric_limits<float>::infinity())) return result;
  polish(scorer_, n, &best);

  const ScoredPose pose = scored_pose(best.T_map_camera);
  for (std::size_t i = 0; i < n; ++i) {
    const PoseScorer::PairCost pair = scorer_.pair_cost(pose, i);
    inlier_mask_[i] = pair.is_inlier ? 1 : 0;
    result.num_inliers += pair.is_inlier ? 1 : 0;
    result.cost += static_cast<double>(pair.squared_error_px);
  }
  // Three pairs fit any pose P3P returns: one more is the least that says something.
  result.is_found = result.num_inliers >= 4;
  result.T_map_camera = {best.T_map_camera.rotation, best.T_map_camera.translation + scorer_.centre()};
  return result;
}

}  // namespace camloc
