// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Perspective-three-point through the degenerate conic of a pencil.
//
// With depths s = (s0, s1, s2) along the unit bearings, each pair of points gives s' M_ij s = a_ij: a_ij is the squared
// distance of the points and M_ij holds 1, 1 and minus the cosine between the bearings. Eliminating the right-hand sides
// leaves two conics s' C s = 0, s' D s = 0 in the ratios of the depths. A member C + g D of their pencil with determinant
// zero is a pair of lines through their common points; each line meets the other conic in at most two of them.
#include "core/geometry/p3p.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace camloc {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr std::array<std::array<int, 2>, 3> kPairs{{{0, 1}, {0, 2}, {1, 2}}};

/// The three distance equations.
struct Distances {
  std::array<double, 3> squared;  ///< a_01, a_02, a_12
  std::array<double, 3> cosine;   ///< of the bearings, same order
  double squared_sum;
};

Vector3d residual_of(const Distances& d, const Vector3d& s) {
  Vector3d r;
  for (std::size_t k = 0; k < 3; ++k) {
    const double si = s[kPairs[k][0]], sj = s[kPairs[k][1]];
    r[static_cast<int>(k)] = si * si + sj * sj - 2.0 * d.cosine[k] * si * sj - d.squared[k];
  }
  return r;
}

/// One real root of x^3 + b x^2 + c x + d, at an end where the cubic is steep: an outer one when there are three.
double real_root_of_cubic(double b, double c, double d) {
  const double discriminant = b * b - 3.0 * c;
  double x = -b / 3.0;  // the inflection point
  const double at_inflection = ((x + b) * x + c) * x + d;
  if (discriminant > 0.0) {
    // Start beyond the extremum whose value has the right sign: from there Newton descends monotonically.
    const double reach = 2.0 * std::sqrt(discriminant) / 3.0;
    x += at_inflection > 0.0 ? -reach : reach;
  } else if (std::abs(discriminant) < 1e-300 && at_inflection == 0.0) {
    return x;
  } else {
    x += at_inflection > 0.0 ? -std::cbrt(at_inflection) : std::cbrt(-at_inflection);
  }
  for (int step = 0; step < 50; ++step) {
    const double value = ((x + b) * x + c) * x + d;
    const double slope = (3.0 * x + 2.0 * b) * x + c;
    if (slope == 0.0) break;
    const double change = value / slope;
    x -= change;
    if (std::abs(change) <= 1e-8 * std::abs(x)) break;  // convergence is quadratic: the next change is below the last bit
  }
  return x;
}

/// det(C + g D) as a cubic in g, highest power first.
std::array<double, 4> determinant_polynomial(const Matrix3d& C, const Matrix3d& D) {
  const auto mixed = [](const Matrix3d& P, const Matrix3d& Q) {  // sum over columns: one column of Q, two of P
    return Q.col(0).dot(P.col(1).cross(P.col(2))) + Q.col(1).dot(P.col(2).cross(P.col(0))) + Q.col(2).dot(P.col(0).cross(P.col(1)));
  };
  return {D.col(0).dot(D.col(1).cross(D.col(2))), mixed(D, C), mixed(C, D), C.col(0).dot(C.col(1).cross(C.col(2)))};
}

/// Splits a symmetric matrix of rank two into the lines l, m with  matrix ~ l m' + m l'. False when they are complex.
bool split_into_lines(const Matrix3d& degenerate, Vector3d* l, Vector3d* m) {
  // Minus the adjugate is v v' with v the lines' common point (Richter-Gebert, "Perspectives on projective geometry", 2011).
  Matrix3d v_vt;
  v_vt.col(0) = degenerate.col(2).cross(degenerate.col(1));
  v_vt.col(1) = degenerate.col(0).cross(degenerate.col(2));
  v_vt.col(2) = degenerate.col(1).cross(degenerate.col(0));
  int k = 0;
  v_vt.diagonal().maxCoeff(&k);
  if (!(v_vt(k, k) > 0.0)) return false;
  const Vector3d v = v_vt.col(k) / std::sqrt(v_vt(k, k));
  Matrix3d rank_one = degenerate;
  rank_one(0, 1) -= v.z();
  rank_one(0, 2) += v.y();
  rank_one(1, 0) += v.z();
  rank_one(1, 2) -= v.x();
  rank_one(2, 0) -= v.y();
  rank_one(2, 1) += v.x();
  int row = 0, column = 0;
  rank_one.cwiseAbs().maxCoeff(&row, &column);
  *l = rank_one.col(column);
  *m = rank_one.row(row).transpose();
  return true;
}

/// At most two Newton steps on the three distance equations.
bool polish(const Distances& d, Vector3d* s) {
  Vector3d r = residual_of(d, *s);
  for (int step = 0; step < 2 && r.cwiseAbs().maxCoeff() > 1e-14 * d.squared_sum; ++step) {
    Matrix3d J = Matrix3d::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      const int i = kPairs[k][0], j = kPairs[k][1];
      J(static_cast<int>(k), i) = 2.0 * ((*s)[i] - d.cosine[k] * (*s)[j]);
      J(static_cast<int>(k), j) = 2.0 * ((*s)[j] - d.cosine[k] * (*s)[i]);
    }
    const Vector3d candidate = *s - J.inverse() * r;  // at a double root not finite or worse: then the root stays as it is
    const Vector3d at_candidate = residual_of(d, candidate);
    if (!(at_candidate.squaredNorm() < r.squaredNorm())) break;
    *s = candidate;
    r = at_candidate;
  }
  return s->minCoeff() > 0.0 && r.cwiseAbs().maxCoeff() <= 1e-6 * d.squared_sum;
}

/// Right-handed orthonormal axes of a triangle: along its first side, across in its plane, normal.
Matrix3d axes_of_triangle(const Vector3d& side_1, const Vector3d& side_2) {
  Matrix3d axes;
  axes.col(0) = side_1.normalized();
  axes.col(2) = side_1.cross(side_2).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return axes;
}

/// A triangle of points and the directions in which they are seen.
struct Triangle {
  const std::array<Vector3d, 3>& bearings;
  const std::array<Vector3d, 3>& points;
  Matrix3d axes_map;
};

void add_pose(const Triangle& triangle, const Vector3d& depths, P3pSolutions* solutions) {
  const Vector3d p0 = depths[0] * triangle.bearings[0];
  const Matrix3d axes_camera = axes_of_triangle(depths[1] * triangle.bearings[1] - p0, depths[2] * triangle.bearings[2] - p0);
  const auto k = static_cast<std::size_t>(solutions->count++);
  solutions->R_camera_map[k].noalias() = axes_camera * triangle.axes_map.transpose();
  solutions->t_camera_map[k] = p0 - solutions->R_camera_map[k] * triangle.points[0];
}

/// Depths (up to scale) where the line meets the conic, scaled by the sum of the distance equations, polished, added.
void intersect(const Vector3d& line, const Matrix3d& conic, const Distances& distances, const Triangle& triangle, P3pSolutions* solutions) {
  int k = 0;
  line.cwiseAbs().maxCoeff(&k);
  const int i = (k + 1) % 3, j = (k + 2) % 3;
  const double e = -line[i] / line[k], f = -line[j] / line[k];  // s_k = e s_i + f s_j
  const double a = conic(i, i) + 2.0 * e * conic(i, k) + e * e * conic(k, k);
  const double b = conic(i, j) + f * conic(i, k) + e * conic(j, k) + e * f * conic(k, k);
  const double c = conic(j, j) + 2.0 * f * conic(j, k) + f * f * conic(k, k);
  double discriminant = b * b - a * c;
  // A double root may come out slightly negative; polishing and its residual decide.
  if (discriminant < -1e-10 * (b * b + std::abs(a * c))) return;
  discriminant = std::max(discriminant, 0.0);
  const double q = -(b + std::copysign(std::sqrt(discriminant), b));
  for (const double ratio : {q / a, c / q}) {  // s_i / s_j
    if (!(ratio > 0.0 && ratio < 1e12) || solutions->count == 4) continue;
    Vector3d s;
    s[i] = ratio;
    s[j] = 1.0;
    s[k] = e * ratio + f;
    if (!(s[k] > 0.0)) continue;
    const Vector3d relative = residual_of({{0, 0, 0}, distances.cosine, 0}, s);
    const double scale_squared = distances.squared_sum / relative.sum();
    if (!(scale_squared > 0.0 && scale_squared < 1e30)) continue;
    s *= std::sqrt(scale_squared);
    if (polish(distances, &s)) add_pose(triangle, s, solutions);
  }
}

}  // namespace

P3pSolutions solve_p3p(const std::array<Vector3d, 3>& bearings_camera, const std::array<Vector3d, 3>& points_map) {
  P3pSolutions solutions;
  Distances d;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto i = static_cast<std::size_t>(kPairs[k][0]), j = static_cast<std::size_t>(kPairs[k][1]);
    d.squared[k] = (points_map[i] - points_map[j]).squaredNorm();
    d.cosine[k] = bearings_camera[i].dot(bearings_camera[j]);
  }
  const auto [a01, a02, a12] = d.squared;
  const auto [c01, c02, c12] = d.cosine;
  d.squared_sum = a01 + a02 + a12;
  const double area = (points_map[1] - points_map[0]).cross(points_map[2] - points_map[0]).squaredNorm();
  if (!(area > 1e-12 * d.squared_sum * d.squared_sum)) return solutions;

  // C = M01 a12 - M12 a01 and D = M02 a12 - M12 a02, both divided by the sum of distances to be free of scale.
  const double w01 = a01 / d.squared_sum, w02 = a02 / d.squared_sum, w12 = a12 / d.squared_sum;
  Matrix3d C, D;
  C << w12, -c01 * w12, 0, -c01 * w12, w12 - w01, c12 * w01, 0, c12 * w01, -w01;
  D << w12, 0, -c02 * w12, 0, -w02, c12 * w02, -c02 * w12, c12 * w02, w12 - w02;

  const std::array<double, 4> p = determinant_polynomial(C, D);
  // The reciprocal cubic where the leading coefficient is the smaller one: g at infinity is the conic D itself.
  const bool is_reversed = std::abs(p[0]) < std::abs(p[3]);
  const double lead = is_reversed ? p[3] : p[0];
  if (lead == 0.0) return solutions;
  const double g =
      is_reversed ? real_root_of_cubic(p[2] / lead, p[1] / lead, p[0] / lead) : real_root_of_cubic(p[1] / lead, p[2] / lead, p[3] / lead);
  const Matrix3d degenerate = is_reversed ? Matrix3d(g * C + D) : Matrix3d(C + g * D);
  const bool is_mostly_D = is_reversed ? std::abs(g) < 1.0 : std::abs(g) > 1.0;

  Vector3d l, m;
  if (!split_into_lines(degenerate, &l, &m)) return solutions;
  const Triangle triangle{bearings_camera, points_map, axes_of_triangle(points_map[1] - points_map[0], points_map[2] - points_map[0])};
  const Matrix3d& other = is_mostly_D ? C : D;
  intersect(l, other, d, triangle, &solutions);
  intersect(m, other, d, triangle, &solutions);
  return solutions;
}

}  // namespace camloc
