// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Written once with the compiler's vector types and compiled for the baseline and for AVX2; lanes and the order of additions
// are the same in both, and contraction is off, so the bits agree.
#include "core/geometry/refinement_equations.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "core/base/avx2.h"
#include "core/geometry/pose_jacobian.h"

namespace camloc {
namespace {

constexpr std::size_t kLanes = 4;
/// The Cauchy loss is a sum of logarithms: taken of the product of this many factors a lane. Each may be up to 2^64.
constexpr std::size_t kPairsPerLogarithm = 16 * kLanes;

using Doubles = double __attribute__((vector_size(kLanes * sizeof(double))));
using Floats = float __attribute__((vector_size(kLanes * sizeof(float))));
using Mask = std::int64_t __attribute__((vector_size(kLanes * sizeof(std::int64_t))));

struct KernelInput {
  const float *x, *y, *X, *Y, *Z, *depth, *sigma;
  std::size_t size;
  double R[9];  ///< camera from map, row-major
  double centre[3];
  double focal_scale;
  RefinementModel model;
};

/// Four pairs.
struct Pairs {
  Doubles x, y, X, Y, Z, depth, sigma;
  Mask is_real;  ///< all but the padding of the last four
};

struct KernelSums {
  ReprojectionSums<Doubles> pixel;
  Doubles d22{}, d23{}, d24{}, d33{}, d34{}, d44{}, e2{}, e3{}, e4{};  ///< of the depth rows (0, 0, -1, -vz, uz, 0)
  Doubles ad{}, ur{}, vr{}, g6{};                                      ///< for the focal scale
  Doubles cost{};
  Doubles product{};
};

CAMLOC_INLINE void load(const float* source, Doubles* lanes) {
  Floats narrow;
  std::memcpy(&narrow, source, sizeof(narrow));
  *lanes = __builtin_convertvector(narrow, Doubles);
}

CAMLOC_INLINE void load_pairs(const KernelInput& in, std::size_t i, Pairs* pairs) {
  load(in.x + i, &pairs->x);
  load(in.y + i, &pairs->y);
  load(in.X + i, &pairs->X);
  load(in.Y + i, &pairs->Y);
  load(in.Z + i, &pairs->Z);
  load(in.depth + i, &pairs->depth);
  load(in.sigma + i, &pairs->sigma);
  pairs->is_real = Mask{-1, -1, -1, -1};
}

/// The last `count` < 4 pairs.
CAMLOC_INLINE void load_tail(const KernelInput& in, std::size_t i, std::size_t count, Pairs* pairs) {
  const float* const sources[] = {in.x, in.y, in.X, in.Y, in.Z, in.depth, in.sigma};
  Doubles* const targets[] = {&pairs->x, &pairs->y, &pairs->X, &pairs->Y, &pairs->Z, &pairs->depth, &pairs->sigma};
  for (std::size_t k = 0; k < std::size(sources); ++k) {
    float padded[kLanes] = {};
    std::memcpy(padded, sources[k] + i, count * sizeof(float));
    load(padded, targets[k]);
  }
  for (std::size_t lane = 0; lane < kLanes; ++lane) pairs->is_real[lane] = lane < count ? -1 : 0;
}

CAMLOC_INLINE void add_focal_terms(const Doubles& u, const Doubles& v, const Doubles& inverse_z, const Doubles& weight, KernelSums* sums) {
  const Doubles d = u * u + v * v, r = 1.0 + d;
  sums->ad += weight * inverse_z * d;
  sums->ur += weight * u * r;
  sums->vr += weight * v * r;
}

CAMLOC_INLINE void add_depth_rows(const Doubles& uz, const Doubles& vz, const Doubles& dz, const Doubles& weight, KernelSums* sums) {
  const Doubles weighted_dz = weight * dz;
  sums->d22 += weight;
  sums->d23 += weight * vz;
  sums->d24 -= weight * uz;
  sums->d33 += weight * vz * vz;
  sums->d34 -= weight * uz * vz;
  sums->d44 += weight * uz * uz;
  sums->e2 -= weighted_dz;
  sums->e3 -= weighted_dz * vz;
  sums->e4 += weighted_dz * uz;
}

template <int N, RobustKernel kKernel>
CAMLOC_INLINE void add_pairs(const KernelInput& in, const Pairs& pairs, KernelSums* sums) {
  const RefinementModel& model = in.model;
  const Doubles zero{}, one = zero + 1.0;
  const Doubles dX = pairs.X - in.centre[0], dY = pairs.Y - in.centre[1], dZ = pairs.Z - in.centre[2];
  const Doubles px = in.R[0] * dX + in.R[1] * dY + in.R[2] * dZ;
  const Doubles py = in.R[3] * dX + in.R[4] * dY + in.R[5] * dZ;
  const Doubles pz = in.R[6] * dX + in.R[7] * dY + in.R[8] * dZ;
  const Mask is_in_front = (pz > kMinRefinementDepth_m) & pairs.is_real;
  const Doubles z = is_in_front ? pz : one;
  const Doubles inverse_z = 1.0 / z;
  const Doubles u = px * inverse_z, v = py * inverse_z;
  const Doubles du = model.focal_px * (in.focal_scale * u - pairs.x), dv = model.focal_px * (in.focal_scale * v - pairs.y);
  const Doubles sigma = pairs.sigma > 0.0 ? pairs.sigma : one;
  const Doubles information = 1.0 / (sigma * sigma);
  const Doubles squared = (du * du + dv * dv) * information;
  const Doubles squared_reach = model.reach_px * model.reach_px * information;
  const Mask is_near = is_in_front & (squared <= squared_reach);
  Doubles limited = is_near ? squared : squared_reach;
  limited = pairs.is_real ? limited : zero;

  // The depth of a pair whose pixel is out of reach says nothing about this pose.
  const Mask has_depth = model.use_depth ? pairs.depth > 0.0 : Mask{};
  const Doubles depth_sigma = model.depth_noise.constant_m + model.depth_noise.quadratic_per_m * pairs.depth * pairs.depth;
  const Doubles depth_information = 1.0 / (has_depth ? depth_sigma * depth_sigma : one);
  const Doubles dz = z - pairs.depth;
  const Doubles squared_depth = dz * dz * depth_information;
  const double squared_depth_reach = model.reach_depth_sigmas * model.reach_depth_sigmas;
  const Mask is_depth_near = is_near & has_depth & (squared_depth <= squared_depth_reach);
  Doubles limited_depth = is_depth_near ? squared_depth : zero + squared_depth_reach;
  limited_depth = has_depth ? limited_depth : zero;

  Doubles weight = information, depth_weight = depth_information;
  if constexpr (kKernel == RobustKernel::kCauchy) {
    const double inverse_c2 = 1.0 / (model.cauchy_scale * model.cauchy_scale);
    const Doubles factor = 1.0 + limited * inverse_c2, depth_factor = 1.0 + limited_depth * inverse_c2;
    sums->product *= factor * depth_factor;
    weight /= factor;
    depth_weight /= depth_factor;
  } else {
    sums->cost += limited + limited_depth;
  }
  weight = is_near ? weight : zero;
  depth_weight = is_depth_near ? depth_weight : zero;

  // What is out of reach may be infinite or not a number: no weight makes that zero.
  const Doubles safe_u = is_near ? u : zero, safe_v = is_near ? v : zero;
  const Doubles safe_du = is_near ? du : zero, safe_dv = is_near ? dv : zero;
  const double scale = model.focal_px * in.focal_scale;
  const Doubles gradient_weight = scale * weight, pixel_weight = scale * gradient_weight;
  sums->pixel.add(safe_u, safe_v, inverse_z, safe_du, safe_dv, gradient_weight, pixel_weight);
  if constexpr (N == 7) {
    add_focal_terms(safe_u, safe_v, inverse_z, pixel_weight, sums);
    sums->g6 += gradient_weight * (safe_u * safe_du + safe_v * safe_dv);
  }
  add_depth_rows(safe_u * z, safe_v * z, is_depth_near ? dz : zero, depth_weight, sums);
}

CAMLOC_INLINE double sum_of(const Doubles& v) { return (v[0] + v[2]) + (v[1] + v[3]); }

CAMLOC_INLINE void reduce(const ReprojectionSums<Doubles>& lanes, ReprojectionSums<double>* total) {
  static_assert(sizeof(lanes) == kLanes * sizeof(*total));
  const auto* source = reinterpret_cast<const Doubles*>(&lanes);
  auto* target = reinterpret_cast<double*>(total);
  for (std::size_t k = 0; k < sizeof(*total) / sizeof(double); ++k) target[k] = sum_of(source[k]);
}

template <int N>
CAMLOC_INLINE void assemble(const KernelSums& sums, double focal_scale, NormalEquations<N>* equations) {
  ReprojectionSums<double> pixel;
  reduce(sums.pixel, &pixel);
  pixel.aad += sum_of(sums.d22);
  pixel.avr += sum_of(sums.d23);
  pixel.aur -= sum_of(sums.d24);
  pixel.h33 += sum_of(sums.d33);
  pixel.h34 += sum_of(sums.d34);
  pixel.h44 += sum_of(sums.d44);
  pixel.g2 += sum_of(sums.e2);
  pixel.g3 += sum_of(sums.e3);
  pixel.g4 += sum_of(sums.e4);
  equations->gradient.template head<6>() = gradient_of(pixel);
  equations->hessian.template topLeftCorner<6, 6>() = hessian_of(pixel);
  if constexpr (N == 7) {
    // The focal scale's column of the Jacobian is (u, v) / focal_scale in units of the scaled focal length.
    Vector6d column;
    column << -pixel.au, -pixel.av, sum_of(sums.ad), sum_of(sums.vr), -sum_of(sums.ur), 0.0;
    equations->hessian.template topRightCorner<6, 1>() = column / focal_scale;
    equations->hessian.template bottomLeftCorner<1, 6>() = column.transpose() / focal_scale;
    equations->hessian(6, 6) = pixel.d / (focal_scale * focal_scale);
    equations->gradient[6] = sum_of(sums.g6) / focal_scale;
  }
}

template <int N, RobustKernel kKernel>
CAMLOC_INLINE void sum_up(const KernelInput& in, NormalEquations<N>* equations) {
  KernelSums sums;
  double logarithms = 0;
  for (std::size_t begin = 0; begin < in.size; begin += kPairsPerLogarithm) {
    const std::size_t end = std::min(begin + kPairsPerLogarithm, in.size);
    sums.product = Doubles{1.0, 1.0, 1.0, 1.0};
    Pairs pairs;
    std::size_t i = begin;
    for (; i + kLanes <= end; i += kLanes) {
      load_pairs(in, i, &pairs);
      add_pairs<N, kKernel>(in, pairs, &sums);
    }
    if (i < end) {
      load_tail(in, i, end - i, &pairs);
      add_pairs<N, kKernel>(in, pairs, &sums);
    }
    if constexpr (kKernel == RobustKernel::kCauchy) {
      for (std::size_t lane = 0; lane < kLanes; ++lane) logarithms += std::log(sums.product[lane]);
    }
  }
  equations->cost = sum_of(sums.cost) + in.model.cauchy_scale * in.model.cauchy_scale * logarithms;
  assemble(sums, in.focal_scale, equations);
}

template <int N>
CAMLOC_INLINE void sum_up_any(const KernelInput& in, NormalEquations<N>* equations) {
  if (in.model.kernel == RobustKernel::kCauchy)
    sum_up<N, RobustKernel::kCauchy>(in, equations);
  else
    sum_up<N, RobustKernel::kTruncated>(in, equations);
}

template <int N>
void sum_up_baseline(const KernelInput& in, NormalEquations<N>* equations) {
  sum_up_any<N>(in, equations);
}

template <int N>
CAMLOC_AVX2 void sum_up_avx2(const KernelInput& in, NormalEquations<N>* equations) {
  sum_up_any<N>(in, equations);
}

}  // namespace

template <int N>
NormalEquations<N> normal_equations(const Correspondences& pairs, const RefinementModel& model, const Rigid3& T_map_camera,
                                    double focal_scale) {
  static const auto function = has_avx2() ? sum_up_avx2<N> : sum_up_baseline<N>;
  KernelInput in{pairs.x.data(),
                 pairs.y.data(),
                 pairs.X.data(),
                 pairs.Y.data(),
                 pairs.Z.data(),
                 pairs.depth_m.data(),
                 pairs.sigma_px.data(),
                 pairs.size(),
                 {},
                 {},
                 focal_scale,
                 model};
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(in.R) = T_map_camera.rotation.conjugate().toRotationMatrix();
  Eigen::Map<Eigen::Vector3d>(in.centre) = T_map_camera.translation;
  NormalEquations<N> equations;
  function(in, &equations);
  return equations;
}

template NormalEquations<6> normal_equations<6>(const Correspondences&, const RefinementModel&, const Rigid3&, double);
template NormalEquations<7> normal_equations<7>(const Correspondences&, const RefinementModel&, const Rigid3&, double);

}  // namespace camloc
