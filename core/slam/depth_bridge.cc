// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/slam/depth_bridge.h"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "core/slam/dead_reckoning.h"

namespace camloc {
namespace {

constexpr double kMaxGapS = 0.25;          // between two frames: farther apart, they are no prediction of each other
constexpr double kMinAnchorOverlap = 0.6;  // below it, the next frame is aligned with this one instead of an earlier one
// How far constant velocity may be off after a time dt: half an acceleration times dt^2, and a little at once.
constexpr double kAccelerationMS2 = 3.0, kAccelerationRadS2 = 10.0, kJitterM = 0.003, kJitterRad = 0.003;

double worst_sigma(const Eigen::Matrix3d& covariance) {
  return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvalues().maxCoeff());
}

}  // namespace

void DepthBridge::begin_at(std::int64_t stamp_ns, const Thumbnail& thumbnail) {
  begin_ns_ = last_ns_ = stamp_ns;
  num_steps_ = 0;
  anchor_ = thumbnail;
  anchor_step_ = last_ = {Rigid3(), Matrix6d::Zero()};
}

void DepthBridge::forget() {
  num_steps_ = 0;
  anchor_ = {};
}

std::optional<DepthBridge::Step> DepthBridge::step(std::int64_t stamp_ns, const Thumbnail& thumbnail,
                                                   const Rigid3& T_begin_camera_expected) {
  const auto end = [this] {
    forget();
    return std::nullopt;
  };
  const double dt_s = seconds(stamp_ns - last_ns_);
  const bool is_in_time = dt_s > 0 && dt_s <= kMaxGapS && !(seconds(stamp_ns - begin_ns_) > numbers_.bridge_max_length_s);
  if (anchor_.empty() || thumbnail.empty() || !is_in_time) return end();
  // Everything in the axes of the begin. The prediction is as good as the last frame and the motion since; of the last frame only
  // counts what came after the anchor.
  const Eigen::Quaterniond R_anchor_begin = anchor_step_.T_begin_camera.rotation.conjugate();
  const Matrix6d motion =
      diagonal_covariance(kJitterM + 0.5 * kAccelerationMS2 * dt_s * dt_s, kJitterRad + 0.5 * kAccelerationRadS2 * dt_s * dt_s);
  const Matrix6d since_anchor = last_.covariance - anchor_step_.covariance + motion;
  const DenseAlignment aligned = aligner_.align(anchor_, thumbnail, anchor_step_.T_begin_camera.inverse() * T_begin_camera_expected,
                                                rotate_covariance(R_anchor_begin, since_anchor));
  if (!aligned.is_aligned) return end();
  Step now;
  now.T_begin_camera = anchor_step_.T_begin_camera * aligned.T_a_b;
  now.covariance = anchor_step_.covariance + rotate_covariance(anchor_step_.T_begin_camera.rotation, aligned.covariance);
  if (worst_sigma(now.covariance.topLeftCorner<3, 3>()) > numbers_.bridge_max_sigma_m ||
      worst_sigma(now.covariance.bottomRightCorner<3, 3>()) > numbers_.bridge_max_sigma_rad)
    return end();
  last_ns_ = stamp_ns;
  last_ = now;
  ++num_steps_;
  if (aligned.overlap < kMinAnchorOverlap) {
    anchor_ = thumbnail;
    anchor_step_ = now;
  }
  return now;
}

}  // namespace camloc
