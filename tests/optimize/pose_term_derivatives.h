// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The check that every term on poses has to pass: its derivatives are those of its residuals.
#pragma once

#include <gtest/gtest.h>

#include "core/geometry/pose_jacobian.h"
#include "core/optimize/terms/pose_terms.h"

namespace camloc::testing {

template <class Term>
void expect_true_derivatives(const Term& term, const std::array<Rigid3, Term::kPoses>& T_map_pose) {
  const auto derivatives = term.linearize(T_map_pose).J;
  for (std::size_t pose = 0; pose < T_map_pose.size(); ++pose) {
    for (int k = 0; k < 6; ++k) {
      constexpr double kStep = 1e-6;
      auto ahead = T_map_pose, back = T_map_pose;
      ahead[pose] = moved_in_camera_axes(T_map_pose[pose], kStep * Vector6d::Unit(k));
      back[pose] = moved_in_camera_axes(T_map_pose[pose], -kStep * Vector6d::Unit(k));
      const auto difference = ((term.linearize(ahead).residual - term.linearize(back).residual) / (2 * kStep)).eval();
      EXPECT_LT((difference - derivatives[pose].col(k)).norm(), 1e-6 * (1 + difference.norm())) << "pose " << pose << " by " << k;
    }
  }
}

}  // namespace camloc::testing
