// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/localize/motion_parallax.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/pose_jacobian.h"
#include "core/geometry/symmetric_system.h"

namespace camloc {
namespace {

using Vector8d = Eigen::Matrix<double, 8, 1>;
using Matrix8d = Eigen::Matrix<double, 8, 8>;

constexpr int kIterations = 8;
/// Mean squared error, in sigmas, below which neither model is better for having less.
constexpr double kNoError = 0.1;
/// What looked flat for a while is still allowed to be a place.
constexpr double kLeastEvidence = -10;
/// An error counts as no more than this many sigmas: a landmark that was mistaken for another speaks neither for a picture nor for a place.
constexpr double kMaxSigmas = 3;
/// Neighbouring features share their errors: what this many say is said once.
constexpr double kSightingsPerStatement = 3;

/// x' ~ H x with H(2, 2) = 1.
Eigen::Vector2d mapped(const Vector8d& h, const Eigen::Vector2d& p) {
  const double w = h[6] * p.x() + h[7] * p.y() + 1;
  return {(h[0] * p.x() + h[1] * p.y() + h[2]) / w, (h[3] * p.x() + h[4] * p.y() + h[5]) / w};
}

double capped(const Eigen::Vector2d& error, double sigma) {
  return std::min(kMaxSigmas * kMaxSigmas, error.squaredNorm() / (sigma * sigma));
}

/// Both frames err.
double sigma_of(const LandmarkSighting& before, const LandmarkSighting& now) { return std::hypot(before.sigma, now.sigma); }

constexpr double kMinDepth_m = 0.05;

Eigen::Vector3d point_before(const LandmarkSighting& before) { return before.depth_m * before.seen.homogeneous(); }

/// The plane that explains the motion from one frame to the other best: Gauss-Newton on the distance in the second image, under
/// Cauchy's kernel, from no motion at all.
template <typename Pairs>
Vector8d fit_homography(const Pairs& pairs) {
  Vector8d h;
  h << 1, 0, 0, 0, 1, 0, 0, 0;
  for (int i = 0; i < kIterations; ++i) {
    Matrix8d information = 1e-6 * Matrix8d::Identity();
    Vector8d gradient = Vector8d::Zero();
    for (const auto& [before, now] : pairs) {
      const Eigen::Vector2d& p = before->seen;
      const Eigen::Vector2d q = mapped(h, p), error = (q - now->seen) / sigma_of(*before, *now);
      const double scale = 1 / (sigma_of(*before, *now) * (h[6] * p.x() + h[7] * p.y() + 1));
      Vector8d u, v;
      u << p.x(), p.y(), 1, 0, 0, 0, -q.x() * p.x(), -q.x() * p.y();
      v << 0, 0, 0, p.x(), p.y(), 1, -q.y() * p.x(), -q.y() * p.y();
      u *= scale;
      v *= scale;
      const double weight = 1 / (1 + error.squaredNorm() / (kMaxSigmas * kMaxSigmas));
      information += weight * (u * u.transpose() + v * v.transpose());
      gradient += weight * (error.x() * u + error.y() * v);
    }
    const Vector8d step = -solve_symmetric<8>(information, gradient);
    if (!step.allFinite()) break;
    h += step;
    if (step.squaredNorm() < 1e-16) break;
  }
  return h;
}

/// The motion that explains it best where things are as far as the map says: from what the poses say, in the same way.
template <typename Pairs>
Rigid3 fit_motion(const Pairs& pairs, Rigid3 T_before_now) {
  for (int i = 0; i < kIterations; ++i) {
    Matrix6d information = 1e-6 * Matrix6d::Identity();
    Vector6d gradient = Vector6d::Zero();
    const Rigid3 T_now_before = T_before_now.inverse();
    for (const auto& [before, now] : pairs) {
      const Eigen::Vector3d p = T_now_before * point_before(*before);
      if (!(p.z() > kMinDepth_m)) continue;
      const double sigma = sigma_of(*before, *now);
      const Eigen::Vector2d error = (p.head<2>() / p.z() - now->seen) / sigma;
      const PointJacobian J = point_jacobian(p.x() / p.z(), p.y() / p.z(), p.z());
      const double weight = 1 / (1 + error.squaredNorm() / (kMaxSigmas * kMaxSigmas));
      information += weight / (sigma * sigma) * (J.u * J.u.transpose() + J.v * J.v.transpose());
      gradient += weight / sigma * (error.x() * J.u + error.y() * J.v);
    }
    const Vector6d step = -solve_symmetric<6>(information, gradient);
    if (!step.allFinite()) break;
    T_before_now = moved_in_camera_axes(T_before_now, step);
    if (step.squaredNorm() < 1e-16) break;
  }
  return T_before_now;
}

}  // namespace

MotionParallax::MotionParallax(const MotionParallaxOptions& options) : options_(options) {
  reference_.reserve(options.max_sightings);
  shared_.reserve(options.max_sightings);
}

void MotionParallax::reset() {
  reference_.clear();
  evidence_ = earlier_evidence_ = 0;
}

bool MotionParallax::add(std::int64_t stamp_ns, const Rigid3& T_map_camera, std::span<LandmarkSighting> sightings) {
  std::sort(sightings.begin(), sightings.end(), [](const LandmarkSighting& a, const LandmarkSighting& b) {
    return a.landmark != b.landmark ? a.landmark < b.landmark : a.sigma < b.sigma;
  });
  find_shared(sightings);
  const bool is_recent = stamp_ns > reference_ns_ && stamp_ns - reference_ns_ <= options_.max_age_ns;
  if (shared_.size() < options_.min_shared || !is_recent)
    start_from(stamp_ns, T_map_camera, sightings);
  else
    evidence_ = compare(T_map_reference_.inverse() * T_map_camera);
  return evidence() >= options_.min_evidence;
}

void MotionParallax::start_from(std::int64_t stamp_ns, const Rigid3& T_map_camera, std::span<const LandmarkSighting> sightings) {
  earlier_evidence_ = std::max(kLeastEvidence, earlier_evidence_ + evidence_);
  evidence_ = 0;
  reference_.clear();
  reference_ns_ = stamp_ns;
  T_map_reference_ = T_map_camera;
  for (const LandmarkSighting& sighting : sightings) {
    const bool is_further = reference_.empty() || reference_.back().landmark != sighting.landmark;
    if (is_further && reference_.size() < options_.max_sightings) reference_.push_back(sighting);
  }
}

// How large the errors are is not known beforehand (blur, a rolling shutter): what counts is by which factor one model has more of them.
double MotionParallax::compare(const Rigid3& T_before_now) const {
  const Vector8d plane = fit_homography(shared_);
  const Rigid3 T_now_before = fit_motion(shared_, T_before_now).inverse();
  double of_picture = 0, of_place = 0;
  for (const auto& [before, now] : shared_) {
    const double sigma = sigma_of(*before, *now);
    of_picture += capped(mapped(plane, before->seen) - now->seen, sigma);
    const Eigen::Vector3d p = T_now_before * point_before(*before);
    of_place += p.z() > kMinDepth_m ? capped(p.head<2>() / p.z() - now->seen, sigma) : kMaxSigmas * kMaxSigmas;
  }
  const auto count = static_cast<double>(shared_.size());
  // Per degree of freedom: a plane has eight parameters, a motion six.
  return count / kSightingsPerStatement * std::log((of_picture / (2 * count - 8) + kNoError) / (of_place / (2 * count - 6) + kNoError));
}

void MotionParallax::find_shared(std::span<const LandmarkSighting> sightings) {
  shared_.clear();
  auto before = reference_.cbegin();
  for (const LandmarkSighting& now : sightings) {
    if (!shared_.empty() && shared_.back().now->landmark == now.landmark) continue;
    while (before != reference_.cend() && before->landmark < now.landmark) ++before;
    if (before == reference_.cend()) return;
    if (before->landmark == now.landmark && shared_.size() < shared_.capacity()) shared_.push_back({&*before, &now});
  }
}

}  // namespace camloc
