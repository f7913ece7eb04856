// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/slam/map_uncertainty.h"

#include <cmath>
#include <cstdint>

#include "core/base/mix_bits.h"
#include "core/geometry/alignment.h"

namespace camloc {
namespace {

constexpr int kNumSplits = 2;             // of all landmarks and links into two halves
constexpr std::size_t kMinKeyframes = 4;  // fewer are no map that could deformation
constexpr int kMaxIterations = 12;        // of each adjustment; they begin where the whole map is

/// Which half a landmark or a link goes to.
struct Split {
  std::uint64_t seed = 0;
  [[nodiscard]] bool is_in(bool second_half, std::uint64_t index) const {
    return ((mix_bits(seed ^ mix_bits(index)) & 1U) != 0) == second_half;
  }
};

// Landmarks that are left without observations take no part.
BundleProblem half_of(const MapExtract& extract, const Split& split, bool second_half) {
  const BundleProblem& whole = extract.problem;
  BundleProblem half{whole.T_map_camera, whole.is_camera_fixed, whole.landmarks_m, {}, whole.priors, {}};
  half.observations.reserve(whole.observations.size() / 2);
  for (const BundleObservation& o : whole.observations) {
    const bool is_control = o.landmark >= extract.landmarks.size();
    if (is_control || split.is_in(second_half, o.landmark)) half.observations.push_back(o);
  }
  for (std::size_t i = 0; i < whole.links.size(); ++i) {
    if (split.is_in(second_half, i)) half.links.push_back(whole.links[i]);
  }
  return half;
}

struct SquaredErrors {
  double m2 = 0, rad2 = 0;  ///< sums over cameras and axes
};

// What is left between two sets of poses after the rigid motion that fits them best, orientations as positions a metre away.
SquaredErrors compare(const std::vector<Rigid3>& a, const std::vector<Rigid3>& b) {
  constexpr double kLeverM = 1.0;
  std::vector<PointPair> pairs;
  for (std::size_t i = 0; i < a.size(); ++i) add_pose_points(a[i], b[i], kLeverM, &pairs);
  const Rigid3 T_a_b = align_rigid(pairs).T_a_b;
  SquaredErrors squares;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Vector6d error = pose_error(a[i], T_a_b * b[i]);
    squares.m2 += error.head<3>().squaredNorm();
    squares.rad2 += error.tail<3>().squaredNorm();
  }
  return squares;
}

}  // namespace

MapUncertainty estimate_uncertainty(const BundleOptions& bundle, const MapExtract& extract) {
  const std::size_t num_cameras = extract.problem.T_map_camera.size();
  if (num_cameras < kMinKeyframes) return {};
  BundleOptions adjustment = bundle;
  adjustment.max_iterations = kMaxIterations;
  SquaredErrors total;
  for (int i = 0; i < kNumSplits; ++i) {
    const Split split{static_cast<std::uint64_t>(i)};
    BundleProblem a = half_of(extract, split, false), b = half_of(extract, split, true);
    adjust_bundle(adjustment, &a);
    adjust_bundle(adjustment, &b);
    const SquaredErrors squares = compare(a.T_map_camera, b.T_map_camera);
    total.m2 += squares.m2;
    total.rad2 += squares.rad2;
  }
  // Half of the evidence has twice the variance, so the difference of two halves has four times that of the whole.
  const double num_values = 4.0 * 3.0 * static_cast<double>(num_cameras) * kNumSplits;
  return {std::sqrt(total.m2 / num_values), std::sqrt(total.rad2 / num_values)};
}

}  // namespace camloc
