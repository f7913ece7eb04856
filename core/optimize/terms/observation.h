// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A landmark as a camera sees it: what the terms of one observation have in common. Terms of observations are evaluated for every
// observation in every iteration and nothing of them is kept, hence they are resolved at compile time, inline and in scalars;
// terms on poses alone are few and need none of that (pose_terms.h). A term of an observation has this shape, and a place in the
// list ObservationTerms of landmark_elimination.h:
//
//   static constexpr int kRows;          residuals
//   Term(const BundleOptions&, const BundleObservation&, const SeenLandmark&);
//   double residual[kRows];              predicted minus measured
//   double weight;                       of each squared residual: robust weight / variance; 0 where the term takes no part
//   double cost;                         after the robust kernel
//   Matrix<double, 6, kRows> by_pose(seen);  derivative of each residual by the pose, in the camera's axes (pose_jacobian.h)
//   array<double, kRows> by_landmark(int axis, seen);  and by the landmark's position in `map`, without the factor ...
//   double landmark_scale(seen);         ... that all rows have in common
#pragma once

#include "core/geometry/rigid3.h"
#include "core/optimize/block_system.h"
#include "core/optimize/bundle_problem.h"

namespace camloc {

/// A camera as the loops read it.
struct BundleCamera {
  double axes[3][3];  ///< r0, r1, r2: axes of the camera in `map`, the columns of R_map_camera
  double centre[3];
  std::uint32_t row;  ///< in the equations, or kFixedPose

  BundleCamera(const Rigid3& T_map_camera, std::uint32_t row_of_pose) : row(row_of_pose) {
    const Eigen::Matrix3d R = T_map_camera.rotation.toRotationMatrix();
    for (int k = 0; k < 3; ++k) {
      for (int i = 0; i < 3; ++i) axes[k][i] = R(i, k);
      centre[k] = T_map_camera.translation[k];
    }
  }
};

/// An observation takes part where its landmark is in front of the camera, less than 45 degrees off, and all is finite.
struct SeenLandmark {
  static constexpr double kMinDepth_m = 0.05;

  const BundleCamera& camera;
  double p[3];             ///< the landmark in the camera
  double u, v, inverse_z;  ///< u = x/z, v = y/z
  double du, dv, off;      ///< predicted minus measured, and the sum of their squares
  bool is_in_view;

  SeenLandmark(const BundleObservation& observation, const BundleCamera& by, const double X[3]) : camera(by) {
    const double d0 = X[0] - by.centre[0], d1 = X[1] - by.centre[1], d2 = X[2] - by.centre[2];
    for (int k = 0; k < 3; ++k) p[k] = by.axes[k][0] * d0 + by.axes[k][1] * d1 + by.axes[k][2] * d2;
    inverse_z = 1.0 / p[2];
    u = p[0] * inverse_z;
    v = p[1] * inverse_z;
    du = u - static_cast<double>(observation.x);
    dv = v - static_cast<double>(observation.y);
    off = du * du + dv * dv;
    is_in_view = p[2] > kMinDepth_m && off < 1.0;
  }
};

/// All terms of one observation.
template <class... Terms>
struct TermList : Terms... {
  static constexpr int kNumRows = (Terms::kRows + ...);

  TermList(const BundleOptions& options, const BundleObservation& observation, const SeenLandmark& seen)
      : Terms(options, observation, seen)... {}
  [[nodiscard]] double cost() const { return (... + Terms::cost); }
  /// visit(term, number of its first row).
  template <class Visit>
  void for_each(const Visit& visit) {
    int row = 0;
    ((visit(static_cast<Terms&>(*this), row), row += Terms::kRows), ...);
  }
};

}  // namespace camloc
