// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Derivatives of what a camera sees by a small change of its pose, shared by the robust loop and the refinement.
//
// A change (position step a, rotation vector b), both in the axes of the *camera*, moves the camera to
//   translation + R_map_camera * a,   R_map_camera * exp(b) = exp(R_map_camera * b) * R_map_camera,
// so turning both halves by R_map_camera gives the left perturbation in the axes of `map` that pose_error() is about.
// A point p in the camera then moves by  -a + p x b.
#pragma once

#include "core/geometry/rigid3.h"

namespace camloc {

/// Rows of the derivative of (u, v) = (x/z, y/z) and of z, for a point with normalized coordinates (u, v) and depth z.
struct PointJacobian {
  Vector6d u, v, z;
};

[[nodiscard]] inline PointJacobian point_jacobian(double u, double v, double z) {
  const double inverse_z = 1.0 / z;
  PointJacobian J;
  J.u << -inverse_z, 0.0, u * inverse_z, u * v, -(1.0 + u * u), v;
  J.v << 0.0, -inverse_z, v * inverse_z, 1.0 + v * v, -u * v, -u;
  J.z << 0.0, 0.0, -1.0, -v * z, u * z, 0.0;
  return J;
}

/// Sums from which the normal equations of reprojection errors are made. The two rows of a point's Jacobian
/// (point_jacobian(), with a = 1 / z),
///   u: ( -a   0  ua   uv    -1-uu   v )
///   v: (  0  -a  va  1+vv    -uv   -u )
/// share so many terms that J'J takes 17 sums of simple products instead of 42; with r = 1 + uu + vv, for example,
/// the entry (3, 5) is uv v - (1 + vv) u = -u, and (2, 3) is a v r.
/// T is double, or a vector of doubles with one point in each lane.
template <typename T>
struct ReprojectionSums {
  T aa{}, aau{}, aav{}, aad{};                    ///< a^2 times 1, u, v and d = uu + vv
  T auv{}, ap{}, aq{}, au{}, av{}, aur{}, avr{};  ///< a times uv, p = 1 + uu, q = 1 + vv, u, v, u r, v r
  T h33{}, h34{}, h44{}, u{}, v{}, d{};
  T g0{}, g1{}, g2{}, g3{}, g4{}, g5{};

  /// A point at normalized (pu, pv) and inverse depth `a`, with residual (du, dv), its gradient and its part of J'J weighted.
  [[gnu::always_inline]] void add(const T& pu, const T& pv, const T& a, const T& du, const T& dv, const T& gradient_weight,
                                  const T& weight) {
    const T uu = pu * pu, vv = pv * pv, uv = pu * pv, pd = uu + vv, r = pd + 1.0, p = uu + 1.0, q = vv + 1.0;
    const T wa = weight * a, waa = wa * a, wu = weight * pu, wv = weight * pv, wau = wa * pu, wav = wa * pv;
    aa += waa;
    aau += waa * pu;
    aav += waa * pv;
    aad += waa * pd;
    auv += wa * uv;
    ap += wa * p;
    aq += wa * q;
    au += wau;
    av += wav;
    aur += wau * r;
    avr += wav * r;
    h33 += weight * (vv * r + q);
    h34 -= weight * uv * (r + 1.0);
    h44 += weight * (uu * r + p);
    u += wu;
    v += wv;
    d += weight * pd;
    const T wdu = gradient_weight * du, wdv = gradient_weight * dv;
    g0 -= a * wdu;
    g1 -= a * wdv;
    g2 += a * (pu * wdu + pv * wdv);
    g3 += uv * wdu + q * wdv;
    g4 -= p * wdu + uv * wdv;
    g5 += pv * wdu - pu * wdv;
  }
};

[[nodiscard]] inline Vector6d gradient_of(const ReprojectionSums<double>& s) {
  Vector6d gradient;
  gradient << s.g0, s.g1, s.g2, s.g3, s.g4, s.g5;
  return gradient;
}

[[nodiscard]] inline Matrix6d hessian_of(const ReprojectionSums<double>& s) {
  Matrix6d hessian;
  hessian << s.aa, 0, -s.aau, -s.auv, s.ap, -s.av,  //
      0, s.aa, -s.aav, -s.aq, s.auv, s.au,          //
      -s.aau, -s.aav, s.aad, s.avr, -s.aur, 0,      //
      -s.auv, -s.aq, s.avr, s.h33, s.h34, -s.u,     //
      s.ap, s.auv, -s.aur, s.h34, s.h44, -s.v,      //
      -s.av, s.au, 0, -s.u, -s.v, s.d;
  return hessian;
}

/// The pose after a change in camera axes.
[[nodiscard]] inline Rigid3 moved_in_camera_axes(const Rigid3& T_map_camera, const Vector6d& change) {
  return {(T_map_camera.rotation * exp_so3(change.tail<3>())).normalized(),
          T_map_camera.translation + T_map_camera.rotation * change.head<3>()};
}

}  // namespace camloc
