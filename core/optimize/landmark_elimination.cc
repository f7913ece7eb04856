// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Schur complement, one landmark at a time. With C = L L' the landmark's damped 3x3 block and W_i that of camera i and the
// landmark, E_i = W_i L^-T and the reduced system loses E_i E_j' for each pair of cameras.
#include "core/optimize/landmark_elimination.h"

#include <algorithm>
#include <cstring>

namespace camloc {
namespace {

using Doubles = double __attribute__((vector_size(16)));
using Block6x3 = Eigen::Matrix<double, 6, 3>;

/// block += A B' (or -= with kSign = -1) for a 6x6 column-major block: where the adjustment spends its time. Written with
/// vectors of two, as the compiler does not keep A in registers otherwise.
template <int kSign>
inline void add_product(const Block6x3& A, const Block6x3& B, double* block) {
  Doubles a[3][3];
  std::memcpy(a, A.data(), sizeof(a));
  for (int column = 0; column < 6; ++column, block += 6) {
    const double b0 = B(column, 0), b1 = B(column, 1), b2 = B(column, 2);
    Doubles c[3];
    std::memcpy(c, block, sizeof(c));
    for (int i = 0; i < 3; ++i) {
      const Doubles product = a[0][i] * b0 + a[1][i] * b1 + a[2][i] * b2;
      if constexpr (kSign > 0)
        c[i] += product;
      else
        c[i] -= product;
    }
    std::memcpy(block, c, sizeof(c));
  }
}

/// A block that is needed soon: they are anywhere in the system, and waiting for them was half of the time.
inline void prefetch_block(const double* block) {
  constexpr int kCacheLineDoubles = 8;
  for (int k = 0; k < 36 + kCacheLineDoubles; k += kCacheLineDoubles) __builtin_prefetch(block + std::min(k, 35), 1);
}

/// Symmetric 3x3 block of a landmark and its gradient.
struct LandmarkBlock {
  double c00 = 0, c10 = 0, c11 = 0, c20 = 0, c21 = 0, c22 = 0;
  double g[3] = {0, 0, 0};

  void add(const BundleTerms& t, const BundleCamera& camera) {
    const double* const r2 = camera.axes[2];
    double q0[3], q1[3];
    for (int i = 0; i < 3; ++i) {
      q0[i] = camera.axes[0][i] - t.u * r2[i];
      q1[i] = camera.axes[1][i] - t.v * r2[i];
    }
    const double a = t.pixel_weight * t.inverse_z * t.inverse_z;
    const double s0 = t.pixel_weight * t.inverse_z * t.du, s1 = t.pixel_weight * t.inverse_z * t.dv, s2 = t.depth_weight * t.dz;
    for (int i = 0; i < 3; ++i) g[i] += s0 * q0[i] + s1 * q1[i] + s2 * r2[i];
    const double b = t.depth_weight;
    c00 += a * (q0[0] * q0[0] + q1[0] * q1[0]) + b * r2[0] * r2[0];
    c10 += a * (q0[1] * q0[0] + q1[1] * q1[0]) + b * r2[1] * r2[0];
    c11 += a * (q0[1] * q0[1] + q1[1] * q1[1]) + b * r2[1] * r2[1];
    c20 += a * (q0[2] * q0[0] + q1[2] * q1[0]) + b * r2[2] * r2[0];
    c21 += a * (q0[2] * q0[1] + q1[2] * q1[1]) + b * r2[2] * r2[1];
    c22 += a * (q0[2] * q0[2] + q1[2] * q1[2]) + b * r2[2] * r2[2];
  }

  double add(const PointPrior& prior, const Eigen::Vector3d& X) {
    const double weight = 1.0 / (prior.sigma_m * prior.sigma_m);
    const Eigen::Vector3d d = X - prior.position_m;
    c00 += weight;
    c11 += weight;
    c22 += weight;
    for (int i = 0; i < 3; ++i) g[i] += weight * d[i];
    return weight * d.squaredNorm();
  }
};

/// L^-1 of the damped block, lower triangle; false where the block is singular.
struct InverseFactor {
  double l00, l10, l11, l20, l21, l22;

  bool compute(const LandmarkBlock& C, double damping) {
    constexpr double kMinPivot = 1e-13;   // relative: below, the pivot is rounding error
    constexpr double kTraceShare = 1e-3;  // of the damping: holds a direction along an axis that nothing measures
    const double grow = 1.0 + damping, trace = C.c00 + C.c11 + C.c22, shift = damping * kTraceShare * trace;
    const double c00 = grow * C.c00 + shift, c11 = grow * C.c11 + shift, c22 = grow * C.c22 + shift;
    const double floor = kMinPivot * trace;
    if (!(c00 > floor)) return false;
    const double a00 = std::sqrt(c00), a10 = C.c10 / a00, a20 = C.c20 / a00;
    const double d11 = c11 - a10 * a10;
    if (!(d11 > floor)) return false;
    const double a11 = std::sqrt(d11), a21 = (C.c21 - a20 * a10) / a11;
    const double d22 = c22 - a20 * a20 - a21 * a21;
    if (!(d22 > floor)) return false;
    l00 = 1.0 / a00;
    l11 = 1.0 / a11;
    l22 = 1.0 / std::sqrt(d22);
    l10 = -a10 * l00 * l11;
    l21 = -a21 * l11 * l22;
    l20 = -(a20 * l00 + a21 * l10) * l22;
    return true;
  }

  [[nodiscard]] Eigen::Vector3d times(const double g[3]) const {
    return {l00 * g[0], l10 * g[0] + l11 * g[1], l20 * g[0] + l21 * g[1] + l22 * g[2]};
  }
  [[nodiscard]] Eigen::Vector3d transposed_times(const Eigen::Vector3d& y) const {
    return {l00 * y[0] + l10 * y[1] + l20 * y[2], l11 * y[1] + l21 * y[2], l22 * y[2]};
  }
};

/// Rows of the derivative by the pose, see pose_jacobian.h.
struct PoseRows {
  Vector6d u, v, z;
  explicit PoseRows(const BundleTerms& t) {
    const double uv = t.u * t.v;
    u << -t.inverse_z, 0.0, t.u * t.inverse_z, uv, -(1.0 + t.u * t.u), t.v;
    v << 0.0, -t.inverse_z, t.v * t.inverse_z, 1.0 + t.v * t.v, -uv, -t.u;
    z << 0.0, 0.0, -1.0, -t.p[1], t.p[0], 0.0;
  }
};

}  // namespace

LandmarkEliminator::Entry* LandmarkEliminator::entry_of(std::uint32_t camera) {
  std::size_t i = entries_.size();
  while (i > 0 && entries_[i - 1].camera > camera) --i;
  if (i > 0 && entries_[i - 1].camera == camera) return &entries_[i - 1];  // one landmark twice in one image
  Entry entry{camera, Eigen::Matrix<double, 6, 3>::Zero()};
  return &*entries_.insert(entries_.begin() + static_cast<std::ptrdiff_t>(i), entry);
}

void LandmarkEliminator::add_camera(const BundleTerms& t, const BundleCamera& camera, ReducedCameras* reduced) {
  const PoseRows J(t);
  const Vector6d wu = t.pixel_weight * J.u, wv = t.pixel_weight * J.v, wz = t.depth_weight * J.z;
  const std::uint32_t row = camera.free_index;
  Block6x3 rows, weighted;
  rows << J.u, J.v, J.z;
  weighted << wu, wv, wz;
  add_product<1>(weighted, rows, reduced->system.block(row, row));
  reduced->diagonal[row] += wu.cwiseProduct(J.u) + wv.cwiseProduct(J.v) + wz.cwiseProduct(J.z);
  reduced->system.gradient(row) += t.du * wu + t.dv * wv + t.dz * wz;
  Entry* const entry = entry_of(row);
  const double* const r2 = camera.axes[2];
  for (int i = 0; i < 3; ++i) {
    const double q0 = (camera.axes[0][i] - t.u * r2[i]) * t.inverse_z, q1 = (camera.axes[1][i] - t.v * r2[i]) * t.inverse_z;
    entry->E.col(i) += q0 * wu + q1 * wv + r2[i] * wz;
  }
}

double LandmarkEliminator::eliminate(const LandmarkObservations& landmark, const Eigen::Vector3d& X, double damping,
                                     ReducedCameras* reduced) {
  entries_.clear();
  LandmarkBlock C;
  double cost = 0;
  for (const BundleObservation* o = landmark.begin; o != landmark.end; ++o) {
    const BundleCamera& camera = cameras_[o->camera];
    const BundleTerms t = bundle_terms(model_, *o, camera, X.data());
    cost += t.cost;
    if (t.pixel_weight == 0.0) continue;
    C.add(t, camera);
    if (camera.free_index != kFixedCamera) add_camera(t, camera, reduced);
  }
  for (const PointPrior* prior = landmark.priors_begin; prior != landmark.priors_end; ++prior) cost += C.add(*prior, X);

  InverseFactor L;
  if (entries_.empty() || !L.compute(C, damping)) return cost;
  const Eigen::Vector3d y = L.times(C.g);
  for (std::size_t j = 0; j < entries_.size(); ++j) {
    Eigen::Matrix<double, 6, 3>& E = entries_[j].E;
    E.col(2) = L.l20 * E.col(0) + L.l21 * E.col(1) + L.l22 * E.col(2);
    E.col(1) = L.l10 * E.col(0) + L.l11 * E.col(1);
    E.col(0) *= L.l00;
    reduced->system.gradient(entries_[j].camera).noalias() -= E * y;
    blocks_.resize(j + 1);
    for (std::size_t i = 0; i <= j; ++i) {
      blocks_[i] = reduced->system.block(entries_[i].camera, entries_[j].camera);
      prefetch_block(blocks_[i]);
    }
    for (std::size_t i = 0; i <= j; ++i) add_product<-1>(entries_[i].E, E, blocks_[i]);
  }
  return cost;
}

Eigen::Vector3d LandmarkEliminator::step(const LandmarkObservations& landmark, const Eigen::Vector3d& X, double damping,
                                         const std::vector<Vector6d>& camera_steps) const {
  LandmarkBlock C;
  for (const BundleObservation* o = landmark.begin; o != landmark.end; ++o) {
    const BundleCamera& camera = cameras_[o->camera];
    BundleTerms t = bundle_terms(model_, *o, camera, X.data());
    if (t.pixel_weight == 0.0) continue;
    if (camera.free_index != kFixedCamera) {
      // The gradient after the camera's step: what its residuals have changed by goes into the residuals.
      const PoseRows J(t);
      const Vector6d& d = camera_steps[camera.free_index];
      t.du += J.u.dot(d);
      t.dv += J.v.dot(d);
      t.dz += J.z.dot(d);
    }
    C.add(t, camera);
  }
  for (const PointPrior* prior = landmark.priors_begin; prior != landmark.priors_end; ++prior) C.add(*prior, X);
  InverseFactor L;
  if (!L.compute(C, damping)) return Eigen::Vector3d::Zero();
  return -L.transposed_times(L.times(C.g));
}

double LandmarkEliminator::cost(const LandmarkObservations& landmark, const Eigen::Vector3d& X) const {
  double cost = 0;
  for (const BundleObservation* o = landmark.begin; o != landmark.end; ++o) {
    cost += bundle_terms(model_, *o, cameras_[o->camera], X.data()).cost;
  }
  for (const PointPrior* p = landmark.priors_begin; p != landmark.priors_end; ++p) {
    cost += (X - p->position_m).squaredNorm() / (p->sigma_m * p->sigma_m);
  }
  return cost;
}

}  // namespace camloc
