// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The scoring kernel. Written once with the compiler's vector types and compiled for the baseline and for AVX2; lanes and
// the order of additions are the same in both, and contraction is off, so the bits agree.
#include "core/geometry/pose_scorer.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/base/avx2.h"

namespace camloc {
namespace {

constexpr std::size_t kLanes = 8;
constexpr std::size_t kPairsPerCheck = 64;
constexpr float kMinDepth_m = 0.05F;
constexpr float kMaxDepth_m = 1e6F;

using Floats = float __attribute__((vector_size(kLanes * sizeof(float))));
using Mask = std::int32_t __attribute__((vector_size(kLanes * sizeof(std::int32_t))));

struct KernelInput {
  const float *x, *y, *X, *Y, *Z, *min_z, *max_z;
  std::size_t padded_size;
  float squared_focal, max_squared_error;
};

CAMLOC_INLINE void load(const float* source, Floats* lanes) { std::memcpy(lanes, source, sizeof(Floats)); }

CAMLOC_INLINE float sum_of(const Floats& v) { return ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7])); }

CAMLOC_INLINE float cost_kernel(const KernelInput& in, const ScoredPose& pose, float limit) {
  Floats sum{};
  for (std::size_t begin = 0; begin < in.padded_size; begin += kPairsPerCheck) {
    const std::size_t end = std::min(begin + kPairsPerCheck, in.padded_size);
    for (std::size_t i = begin; i < end; i += kLanes) {
      Floats x, y, X, Y, Z, min_z, max_z;
      load(in.x + i, &x);
      load(in.y + i, &y);
      load(in.X + i, &X);
      load(in.Y + i, &Y);
      load(in.Z + i, &Z);
      load(in.min_z + i, &min_z);
      load(in.max_z + i, &max_z);
      const Floats px = pose.R[0] * X + pose.R[1] * Y + pose.R[2] * Z + pose.t[0];
      const Floats py = pose.R[3] * X + pose.R[4] * Y + pose.R[5] * Z + pose.t[1];
      const Floats pz = pose.R[6] * X + pose.R[7] * Y + pose.R[8] * Z + pose.t[2];
      const Floats inverse_z = 1.0F / pz;
      const Floats du = px * inverse_z - x, dv = py * inverse_z - y;
      const Floats squared = in.squared_focal * (du * du + dv * dv);
      const Mask is_inlier = (squared < in.max_squared_error) & (pz >= min_z) & (pz <= max_z);
      sum += is_inlier ? squared : in.max_squared_error;
    }
    const float so_far = sum_of(sum);
    if (so_far >= limit) return so_far;
  }
  return sum_of(sum);
}

float cost_baseline(const KernelInput& in, const ScoredPose& pose, float limit) { return cost_kernel(in, pose, limit); }
CAMLOC_AVX2 float cost_avx2(const KernelInput& in, const ScoredPose& pose, float limit) { return cost_kernel(in, pose, limit); }

std::size_t padded(std::size_t size) { return (size + kLanes - 1) / kLanes * kLanes; }

}  // namespace

PoseScorer::PoseScorer(std::size_t max_pairs) {
  for (std::vector<float>* values : {&x_, &y_, &X_, &Y_, &Z_, &depth_, &min_z_, &max_z_}) values->assign(padded(max_pairs), 0.0F);
}

void PoseScorer::set_pairs(const Correspondences& pairs, std::size_t count, double focal_px, double max_error_px,
                           double max_relative_depth_error) {
  size_ = std::min({count, pairs.size(), x_.size()});
  squared_focal_ = static_cast<float>(focal_px * focal_px);
  max_squared_error_ = static_cast<float>(max_error_px * max_error_px);
  centre_.setZero();
  for (std::size_t i = 0; i < size_; ++i) centre_ += Eigen::Vector3d(pairs.X[i], pairs.Y[i], pairs.Z[i]);
  if (size_ > 0) centre_ /= static_cast<double>(size_);
  const float relative = static_cast<float>(max_relative_depth_error);
  for (std::size_t i = 0; i < size_; ++i) {
    x_[i] = pairs.x[i];
    y_[i] = pairs.y[i];
    X_[i] = static_cast<float>(pairs.X[i] - centre_.x());
    Y_[i] = static_cast<float>(pairs.Y[i] - centre_.y());
    Z_[i] = static_cast<float>(pairs.Z[i] - centre_.z());
    const bool has_depth = relative > 0.0F && pairs.depth_m[i] > 0.0F;
    depth_[i] = has_depth ? pairs.depth_m[i] : 0.0F;
    min_z_[i] = has_depth ? std::max(kMinDepth_m, depth_[i] * (1.0F - relative)) : kMinDepth_m;
    max_z_[i] = has_depth ? depth_[i] * (1.0F + relative) : kMaxDepth_m;
  }
  for (std::size_t i = size_; i < padded(size_); ++i) {
    x_[i] = y_[i] = X_[i] = Y_[i] = Z_[i] = depth_[i] = 0.0F;
    min_z_[i] = 1.0F;
    max_z_[i] = -1.0F;
  }
}

float PoseScorer::cost(const ScoredPose& pose, float limit) const {
  static const auto function = has_avx2() ? cost_avx2 : cost_baseline;
  const KernelInput input{x_.data(),     y_.data(),     X_.data(),     Y_.data(),      Z_.data(),
                          min_z_.data(), max_z_.data(), padded(size_), squared_focal_, max_squared_error_};
  return function(input, pose, limit);
}

}  // namespace camloc
