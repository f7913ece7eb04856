// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Schur complement, one landmark at a time. With C = L L' the landmark's damped 3x3 block and W_i that of camera i and the
// landmark, E_i = W_i L^-T and the reduced system loses E_i E_j' for each pair of cameras.
#include "core/optimize/landmark_elimination.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <utility>

namespace camloc {
namespace {

using Doubles = double __attribute__((vector_size(16)));
using DoublesInMemory = double __attribute__((vector_size(16), aligned(8), may_alias));

/// block += A B' (or -= with kSign = -1) for a 6x6 column-major block: where the adjustment spends its time. Written with
/// vectors of two, as the compiler does not keep A in registers otherwise.
template <int kSign, int... k>
inline void add_product(const Eigen::Matrix<double, 6, sizeof...(k)>& A, const Eigen::Matrix<double, 6, sizeof...(k)>& B, double* block,
                        std::integer_sequence<int, k...>) {
  Doubles a[sizeof...(k)][3];
  std::memcpy(a, A.data(), sizeof(a));
  auto* c = reinterpret_cast<DoublesInMemory*>(block);
  for (int column = 0; column < 6; ++column, c += 3) {
    const double b[] = {B(column, k)...};
    for (int i = 0; i < 3; ++i) {
      const Doubles product = (... + (a[k][i] * b[k]));
      c[i] = kSign > 0 ? c[i] + product : c[i] - product;
    }
  }
}

template <int kSign, int kColumns>
inline void add_product(const Eigen::Matrix<double, 6, kColumns>& A, const Eigen::Matrix<double, 6, kColumns>& B, double* block) {
  add_product<kSign>(A, B, block, std::make_integer_sequence<int, kColumns>());
}

/// A block that is needed soon: they are anywhere in the system, and waiting for them was half of the time.
inline void prefetch_block(const double* block) {
  constexpr int kCacheLineDoubles = 8;
  for (int k = 0; k < 36 + kCacheLineDoubles; k += kCacheLineDoubles) __builtin_prefetch(block + std::min(k, 35), 1);
}

/// Symmetric block of a landmark and its gradient.
struct LandmarkBlock {
  double c00 = 0, c10 = 0, c11 = 0, c20 = 0, c21 = 0, c22 = 0;
  double g[3] = {0, 0, 0};

  void add_isotropic(double weight, const Eigen::Vector3d& residual) {
    c00 += weight;
    c11 += weight;
    c22 += weight;
    for (int i = 0; i < 3; ++i) g[i] += weight * residual[i];
  }
};

/// L^-1 of the damped block C = L L', lower triangle.
struct InverseFactor {
  double l00, l10, l11, l20, l21, l22;

  /// False where the block is singular.
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

/// What a term adds to its landmark's block.
template <class Term>
struct LandmarkPart {
  std::array<double, Term::kRows> q[3], pull;  ///< derivatives by axis, and what pulls along them
  double information;

  LandmarkPart(const Term& term, const SeenLandmark& seen) {
    const double scale = term.landmark_scale(seen);
    information = term.weight * scale * scale;
    for (int axis = 0; axis < 3; ++axis) q[axis] = term.by_landmark(axis, seen);
    for (int row = 0; row < Term::kRows; ++row) pull[row] = term.weight * scale * term.residual[row];
  }
  [[nodiscard]] double gradient(int i) const {
    double sum = pull[0] * q[i][0];
    for (int row = 1; row < Term::kRows; ++row) sum += pull[row] * q[i][row];
    return sum;
  }
  [[nodiscard]] double block(int i, int j) const {
    if constexpr (Term::kRows == 1) return information * q[i][0] * q[j][0];
    double sum = q[i][0] * q[j][0];
    for (int row = 1; row < Term::kRows; ++row) sum += q[i][row] * q[j][row];
    return information * sum;
  }
};

template <class... Terms>
[[gnu::always_inline]] inline void add_to(const TermList<Terms...>& terms, const SeenLandmark& seen, LandmarkBlock* C) {
  const auto add_parts = [C](const auto&... parts) {
    for (int i = 0; i < 3; ++i) C->g[i] += (... + parts.gradient(i));
    C->c00 += (... + parts.block(0, 0));
    C->c10 += (... + parts.block(1, 0));
    C->c11 += (... + parts.block(1, 1));
    C->c20 += (... + parts.block(2, 0));
    C->c21 += (... + parts.block(2, 1));
    C->c22 += (... + parts.block(2, 2));
  };
  add_parts(LandmarkPart<Terms>(terms, seen)...);
}

}  // namespace

LandmarkEliminator::Entry* LandmarkEliminator::entry_of(std::uint32_t row) {
  std::size_t i = entries_.size();
  while (i > 0 && entries_[i - 1].row > row) --i;
  if (i > 0 && entries_[i - 1].row == row) return &entries_[i - 1];  // one landmark twice in one image
  Entry entry{row, Eigen::Matrix<double, 6, 3>::Zero()};
  return &*entries_.insert(entries_.begin() + static_cast<std::ptrdiff_t>(i), entry);
}

void LandmarkEliminator::add_camera(ObservationTerms& terms, const SeenLandmark& seen, BlockSystem* reduced) {
  constexpr int kNumRows = ObservationTerms::kNumRows;
  Eigen::Matrix<double, 6, kNumRows> J, weighted;
  double residual[kNumRows], weight[kNumRows], by_landmark[kNumRows][3];
  terms.for_each([&](const auto& term, int first) {
    const auto own = term.by_pose(seen);
    const double scale = term.landmark_scale(seen);
    for (int k = 0; k < term.kRows; ++k) {
      J.col(first + k) = own.col(k);
      residual[first + k] = term.residual[k];
      weight[first + k] = term.weight;
    }
    for (int axis = 0; axis < 3; ++axis) {
      const auto q = term.by_landmark(axis, seen);
      for (int k = 0; k < term.kRows; ++k) by_landmark[first + k][axis] = q[k] * scale;
    }
  });
  for (int k = 0; k < kNumRows; ++k) weighted.col(k) = weight[k] * J.col(k);
  const std::uint32_t row = seen.camera.row;
  add_product<1>(weighted, J, reduced->block(row, row));
  Vector6d diagonal = weighted.col(0).cwiseProduct(J.col(0)), gradient = residual[0] * weighted.col(0);
  for (int k = 1; k < kNumRows; ++k) {
    diagonal += weighted.col(k).cwiseProduct(J.col(k));
    gradient += residual[k] * weighted.col(k);
  }
  reduced->diagonal(row) += diagonal;
  reduced->gradient(row) += gradient;
  Entry* const entry = entry_of(row);
  for (int axis = 0; axis < 3; ++axis) {
    Vector6d column = by_landmark[0][axis] * weighted.col(0);
    for (int k = 1; k < kNumRows; ++k) column += by_landmark[k][axis] * weighted.col(k);
    entry->E.col(axis) += column;
  }
}

double LandmarkEliminator::eliminate(const LandmarkObservations& landmark, const Eigen::Vector3d& X, double damping, BlockSystem* reduced) {
  entries_.clear();
  LandmarkBlock C;
  double cost = 0;
  for (const BundleObservation& o : landmark.observations) {
    const SeenLandmark seen(o, cameras_[o.camera], X.data());
    ObservationTerms terms(options_, o, seen);
    cost += terms.cost();
    if (!seen.is_in_view) continue;
    add_to(terms, seen, &C);
    if (seen.camera.row != kFixedPose) add_camera(terms, seen, reduced);
  }
  for (const PointPrior& prior : landmark.priors) {
    C.add_isotropic(prior.weight(), X - prior.position_m);
    cost += prior.cost(X);
  }

  InverseFactor L;
  if (entries_.empty() || !L.compute(C, damping)) return cost;
  const Eigen::Vector3d y = L.times(C.g);
  for (std::size_t j = 0; j < entries_.size(); ++j) {
    Eigen::Matrix<double, 6, 3>& E = entries_[j].E;
    E.col(2) = L.l20 * E.col(0) + L.l21 * E.col(1) + L.l22 * E.col(2);
    E.col(1) = L.l10 * E.col(0) + L.l11 * E.col(1);
    E.col(0) *= L.l00;
    reduced->gradient(entries_[j].row).noalias() -= E * y;
    blocks_.resize(j + 1);
    for (std::size_t i = 0; i <= j; ++i) {
      blocks_[i] = reduced->block(entries_[i].row, entries_[j].row);
      prefetch_block(blocks_[i]);
    }
    for (std::size_t i = 0; i <= j; ++i) add_product<-1>(entries_[i].E, E, blocks_[i]);
  }
  return cost;
}

Eigen::Vector3d LandmarkEliminator::step(const LandmarkObservations& landmark, const Eigen::Vector3d& X, double damping,
                                         const std::vector<Vector6d>& camera_steps) const {
  LandmarkBlock C;
  for (const BundleObservation& o : landmark.observations) {
    const SeenLandmark seen(o, cameras_[o.camera], X.data());
    ObservationTerms terms(options_, o, seen);
    if (!seen.is_in_view) continue;
    if (seen.camera.row != kFixedPose) {
      // The gradient after the camera's step: what its residuals have changed by goes into the residuals.
      const Vector6d& d = camera_steps[seen.camera.row];
      terms.for_each([&](auto& term, int) {
        const auto J = term.by_pose(seen);
        for (int row = 0; row < term.kRows; ++row) term.residual[row] += J.col(row).dot(d);
      });
    }
    add_to(terms, seen, &C);
  }
  for (const PointPrior& prior : landmark.priors) C.add_isotropic(prior.weight(), X - prior.position_m);
  InverseFactor L;
  if (!L.compute(C, damping)) return Eigen::Vector3d::Zero();
  return -L.transposed_times(L.times(C.g));
}

double LandmarkEliminator::cost(const LandmarkObservations& landmark, const Eigen::Vector3d& X) const {
  double cost = 0;
  for (const BundleObservation& o : landmark.observations) {
    cost += ObservationTerms(options_, o, SeenLandmark(o, cameras_[o.camera], X.data())).cost();
  }
  for (const PointPrior& prior : landmark.priors) cost += prior.cost(X);
  return cost;
}

}  // namespace camloc
