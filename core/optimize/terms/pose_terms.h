// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Terms on poses, in blocks of one kind: a bundle adjustment or a pose graph sees a block through PoseTerms, and within it all is
// resolved at compile time. A term on poses is a struct of this shape:
//
//   static constexpr int kRows, kPoses;                  residuals; poses they are about, 1 or 2
//   std::array<std::uint32_t, kPoses> poses() const;     which
//   PoseResidual<kRows, kPoses> linearize(const std::array<Rigid3, kPoses>& T_map_pose) const;
//
// One that is not about landmarks needs no other file: PoseTermsOf<Term> goes into BundleProblem::pose_terms.
// tests/optimize/term_seam_test.cc is an example. Terms of observations are in observation.h.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/rigid3.h"
#include "core/optimize/block_system.h"
#include "core/optimize/terms/kernels.h"

namespace camloc {

/// Residuals in their standard deviations, and their derivatives by each pose changing in its own axes (pose_jacobian.h). Where a
/// residual is infinite the term takes no part.
template <int kRows, int kPoses>
struct PoseResidual {
  Eigen::Matrix<double, kRows, 1> residual;
  std::array<Eigen::Matrix<double, kRows, 6>, kPoses> J;
};

/// D with log(exp(r) exp(d)) = r + D d for small d: the inverse right Jacobian of SO(3).
[[nodiscard]] Eigen::Matrix3d inverse_right_jacobian(const Eigen::Vector3d& r);

/// Residuals and derivatives times L^-1, with covariance = L L'. Where it is not positive definite, or the residual not finite, the
/// residual becomes infinite and the derivatives zero.
template <int kPoses>
void whiten(const Matrix6d& covariance, PoseResidual<6, kPoses>* term);

/// A block of terms. `rows` says where the poses are in the equations, kFixedPose for those that are held.
class PoseTerms {
 public:
  virtual ~PoseTerms() = default;
  /// The blocks of the equations that the terms need.
  virtual void mark(const std::vector<std::uint32_t>& rows, BlockPattern* pattern) const = 0;
  /// `cost` and what the terms cost.
  [[nodiscard]] virtual double add_cost(const std::vector<Rigid3>& T_map_pose, double cost) const = 0;
  /// The same, and adds the terms to the equations.
  virtual double add(const std::vector<Rigid3>& T_map_pose, const std::vector<std::uint32_t>& rows, double cost,
                     BlockSystem* equations) const = 0;
};

/// Refers to the terms; all are under Cauchy's kernel of that width over the length of their residuals, 0 = none.
template <class Term>
class PoseTermsOf final : public PoseTerms {
 public:
  PoseTermsOf(std::span<const Term> terms, double kernel_sigmas) : terms_(terms), kernel_sigmas_(kernel_sigmas) {}

  void mark(const std::vector<std::uint32_t>& rows, BlockPattern* pattern) const override {
    for (const Term& term : terms_) {
      const auto poses = term.poses();
      if (rows[poses.front()] != kFixedPose && rows[poses.back()] != kFixedPose) pattern->add(rows[poses.front()], rows[poses.back()]);
    }
  }

  [[nodiscard]] double add_cost(const std::vector<Rigid3>& T_map_pose, double cost) const override {
    for (const double squared : chi2(T_map_pose)) cost += cauchy(squared, kernel_sigmas_).cost;
    return cost;
  }

  double add(const std::vector<Rigid3>& T_map_pose, const std::vector<std::uint32_t>& rows, double cost,
             BlockSystem* equations) const override {
    for (const Term& term : terms_) {
      const auto [residual, J] = linearize(term, T_map_pose);
      const RobustCost robust = cauchy(residual.squaredNorm(), kernel_sigmas_);
      cost += robust.cost;
      const auto poses = term.poses();
      if (robust.weight == 0.0 || (Term::kPoses == 2 && poses.front() == poses.back())) continue;
      for (std::size_t k = 0; k < poses.size(); ++k) add_pose(J[k], residual, robust.weight, rows[poses[k]], equations);
      if constexpr (Term::kPoses == 2) add_pair(J, robust.weight, rows[poses[0]], rows[poses[1]], equations);
    }
    return cost;
  }

  /// Squared length of each term's residuals.
  [[nodiscard]] std::vector<double> chi2(const std::vector<Rigid3>& T_map_pose) const {
    std::vector<double> result;
    for (const Term& term : terms_) result.push_back(linearize(term, T_map_pose).residual.squaredNorm());
    return result;
  }

 private:
  using Jacobian = Eigen::Matrix<double, Term::kRows, 6>;
  using Residual = Eigen::Matrix<double, Term::kRows, 1>;

  static PoseResidual<Term::kRows, Term::kPoses> linearize(const Term& term, const std::vector<Rigid3>& T_map_pose) {
    std::array<Rigid3, Term::kPoses> own;
    const auto poses = term.poses();
    for (std::size_t k = 0; k < poses.size(); ++k) own[k] = T_map_pose[poses[k]];
    return term.linearize(own);
  }

  static void add_pose(const Jacobian& J, const Residual& residual, double weight, std::uint32_t row, BlockSystem* equations) {
    if (row == kFixedPose) return;
    const Matrix6d H = weight * J.transpose() * J;
    Eigen::Map<Matrix6d>(equations->block(row, row)) += H;
    equations->diagonal(row) += H.diagonal();
    equations->gradient(row) += weight * J.transpose() * residual;
  }

  static void add_pair(const std::array<Jacobian, 2>& J, double weight, std::uint32_t i, std::uint32_t j, BlockSystem* equations) {
    if (i == kFixedPose || j == kFixedPose) return;
    const Jacobian& J_row = i < j ? J[0] : J[1];
    const Jacobian& J_column = i < j ? J[1] : J[0];
    Eigen::Map<Matrix6d>(equations->block(std::min(i, j), std::max(i, j))) += weight * J_row.transpose() * J_column;
  }

  std::span<const Term> terms_;
  double kernel_sigmas_;
};

}  // namespace camloc
