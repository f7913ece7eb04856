// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Schur complement, one landmark at a time. With C = L L' the landmark's damped 3x3 block and W_i that of camera i and the
// landmark, E_i = W_i L^-T and the reduced system loses E_i E_j' for each pair of cameras.
#include "core/optimize/landmark_elimination.h"

#include <algorithm>
#include <array>
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

void LandmarkEliminator::add_camera(ObservationTerms& terms, const SeenLandmark& seen, PoseEquations* reduced) {
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
  add_product<1>(weighted, J, reduced->system.block(row, row));
  Vector6d diagonal = weighted.col(0).cwiseProduct(J.col(0)), gradient = residual[0] * weighted.col(0);
  for (int k = 1; k < kNumRows; ++k) {
    diagonal += weighted.col(k).cwiseProduct(J.col(k));
    gradient += residual[k] * weighted.col(k);
  }
  reduced->diagonal[row] += diagonal;
  reduced->system.gradient(row) += gradient;
  Entry* const entry = entry_of(row);
  for (int axis = 0; axis < 3; ++axis) {
    Vector6d column = by_landmark[0][axis] * weighted.col(0);
    for (int k = 1; k < kNumRows; ++k) column += by_landmark[k][axis] * weighted.col(k);
    entry->E.col(axis) += column;
  }
}

double LandmarkEliminator::eliminate(const LandmarkObservations& landmark, const Eigen::Vector3d& X, double damping,
                                     PoseEquations* reduced) {
  entries_.clear();
  LandmarkBlock C;
  double cost = 0;
  for (const BundleObservation* o = landmark.begin; o != landmark.end; ++o) {
    const SeenLandmark seen(*o, cameras_[o->camera], X.data());
    ObservationTerms terms(options_, *o, seen);
    cost += terms.cost();
    if (!seen.is_in_view) continue;
    add_to(terms, seen, &C);
    if (seen.camera.row != kFixedPose) add_camera(terms, seen, reduced);
  }
  for (const PointPrior* prior = landmark.priors_begin; prior != landmark.priors_end; ++prior) {
    prior->add_to(X, &C);
    cost += prior->cost(X);
  }

  InverseFactor L;
  if (entries_.empty() || !L.compute(C, damping)) return cost;
  const Eigen::Vector3d y = L.times(C.g);
  for (std::size_t j = 0; j < entries_.size(); ++j) {
    Eigen::Matrix<double, 6, 3>& E = entries_[j].E;
    E.col(2) = L.l20 * E.col(0) + L.l21 * E.col(1) + L.l22 * E.col(2);
    E.col(1) = L.l10 * E.col(0) + L.l11 * E.col(1);
    E.col(0) *= L.l00;
    reduced->system.gradient(entries_[j].row).noalias() -= E * y;
    blocks_.resize(j + 1);
    for (std::size_t i = 0; i <= j; ++i) {
      blocks_[i] = reduced->system.block(entries_[i].row, entries_[j].row);
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
    const SeenLandmark seen(*o, cameras_[o->camera], X.data());
    ObservationTerms terms(options_, *o, seen);
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
  for (const PointPrior* prior = landmark.priors_begin; prior != landmark.priors_end; ++prior) prior->add_to(X, &C);
  InverseFactor L;
  if (!L.compute(C, damping)) return Eigen::Vector3d::Zero();
  return -L.transposed_times(L.times(C.g));
}

double LandmarkEliminator::cost(const LandmarkObservations& landmark, const Eigen::Vector3d& X) const {
  double cost = 0;
  for (const BundleObservation* o = landmark.begin; o != landmark.end; ++o) {
    cost += ObservationTerms(options_, *o, SeenLandmark(*o, cameras_[o->camera], X.data())).cost();
  }
  for (const PointPrior* p = landmark.priors_begin; p != landmark.priors_end; ++p) cost += p->cost(X);
  return cost;
}

}  // namespace camloc
