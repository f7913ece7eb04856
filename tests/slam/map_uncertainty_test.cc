// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The estimate against what adjusted maps are really off by, which only generated worlds tell.
#include "core/slam/map_uncertainty.h"

#include <gtest/gtest.h>

#include <random>

#include "core/geometry/alignment.h"
#include "tests/optimize/generated_bundle.h"

namespace camloc {
namespace {

using testing::BundleWorld;
using testing::BundleWorldOptions;

MapExtract extract_of(const BundleWorld& world) {
  MapExtract extract;
  extract.problem = world.start;
  for (std::uint32_t i = 0; i < world.start.landmarks_m.size(); ++i) extract.landmarks.push_back(i);
  return extract;
}

/// An adjusted map and what its keyframes are off by per axis, best alignment taken out.
struct Adjusted {
  MapExtract extract;
  MapUncertainty truth;
};

Adjusted adjust(const BundleWorld& world) {
  Adjusted adjusted{extract_of(world), {}};
  adjust_bundle(world.options, &adjusted.extract.problem);
  const std::vector<Rigid3>& estimate = adjusted.extract.problem.T_map_camera;
  std::vector<PointPair> pairs;
  for (std::size_t i = 0; i < estimate.size(); ++i) add_pose_points(world.truth.T_map_camera[i], estimate[i], 1.0, &pairs);
  const Rigid3 T = align_rigid(pairs).T_a_b;
  double m2 = 0, rad2 = 0;
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    const Vector6d error = pose_error(world.truth.T_map_camera[i], T * estimate[i]);
    m2 += error.head<3>().squaredNorm();
    rad2 += error.tail<3>().squaredNorm();
  }
  const double num_values = 3.0 * static_cast<double>(estimate.size());
  adjusted.truth = {std::sqrt(m2 / num_values), std::sqrt(rad2 / num_values)};
  return adjusted;
}

/// Mean squares over several worlds: one map alone has few directions that it can deformation in.
struct Compared {
  MapUncertainty estimate, truth;
};

Compared compare(const BundleWorldOptions& options, int num_worlds) {
  double estimate_m2 = 0, estimate_rad2 = 0, truth_m2 = 0, truth_rad2 = 0;
  for (int seed = 0; seed < num_worlds; ++seed) {
    std::mt19937 rng(static_cast<unsigned>(seed));
    const BundleWorld world = make_bundle_world(rng, options);
    const Adjusted adjusted = adjust(world);
    const MapUncertainty estimate = estimate_uncertainty(world.options, adjusted.extract);
    estimate_m2 += estimate.sigma_m * estimate.sigma_m;
    estimate_rad2 += estimate.sigma_rad * estimate.sigma_rad;
    truth_m2 += adjusted.truth.sigma_m * adjusted.truth.sigma_m;
    truth_rad2 += adjusted.truth.sigma_rad * adjusted.truth.sigma_rad;
  }
  return {{std::sqrt(estimate_m2), std::sqrt(estimate_rad2)}, {std::sqrt(truth_m2), std::sqrt(truth_rad2)}};
}

void expect_honest(const Compared& compared) {
  EXPECT_GT(compared.estimate.sigma_m, 0.75 * compared.truth.sigma_m);
  EXPECT_LT(compared.estimate.sigma_m, 1.5 * compared.truth.sigma_m);
  EXPECT_GT(compared.estimate.sigma_rad, 0.75 * compared.truth.sigma_rad);
  EXPECT_LT(compared.estimate.sigma_rad, 1.5 * compared.truth.sigma_rad);
}

BundleWorldOptions room() { return {.num_cameras = 30, .num_landmarks = 600, .seen_ratio = 0.7}; }
BundleWorldOptions corridor() { return {.num_cameras = 40, .num_landmarks = 900, .corridor_m = 60}; }

TEST(MapUncertainty, IsWhatARoomIsOffBy) { expect_honest(compare(room(), 6)); }

TEST(MapUncertainty, IsWhatACorridorIsOffBy) { expect_honest(compare(corridor(), 6)); }

// Errors that are larger than the adjustment was told: the normal equations would promise too much.
TEST(MapUncertainty, DoesNotTrustTheSigmas) {
  BundleWorldOptions options = corridor();
  options.noise_px = 3;
  double estimate_m2 = 0, truth_m2 = 0;
  for (unsigned seed = 0; seed < 6; ++seed) {
    std::mt19937 rng(seed);
    BundleWorld world = make_bundle_world(rng, options);
    for (BundleObservation& o : world.start.observations) o.sigma_px = 1;
    const Adjusted adjusted = adjust(world);
    const double sigma_m = estimate_uncertainty(world.options, adjusted.extract).sigma_m;
    estimate_m2 += sigma_m * sigma_m;
    truth_m2 += adjusted.truth.sigma_m * adjusted.truth.sigma_m;
  }
  EXPECT_GT(estimate_m2, 0.56 * truth_m2);
  EXPECT_LT(estimate_m2, 2.25 * truth_m2);
}

TEST(MapUncertainty, SurveyedPointsHoldAMap) {
  std::mt19937 rng(4);
  BundleWorld world = make_bundle_world(rng, corridor());
  const double free_m = estimate_uncertainty(world.options, adjust(world).extract).sigma_m;
  // The last landmarks are control points, as extract_segment puts them.
  constexpr std::size_t kStep = 20;
  MapExtract held = adjust(world).extract;
  std::vector<std::uint32_t> new_number(held.landmarks.size());
  std::vector<Eigen::Vector3d> positions;
  for (const bool are_controls : {false, true}) {
    for (std::uint32_t i = 0; i < held.landmarks.size(); ++i) {
      if ((i % kStep == 0) != are_controls) continue;
      new_number[i] = static_cast<std::uint32_t>(positions.size());
      if (are_controls) held.problem.priors.push_back({new_number[i], world.truth.landmarks_m[i], 0.001});
      positions.push_back(held.problem.landmarks_m[i]);
    }
  }
  held.problem.landmarks_m = positions;
  for (BundleObservation& o : held.problem.observations) o.landmark = new_number[o.landmark];
  std::stable_sort(held.problem.observations.begin(), held.problem.observations.end(),
                   [](const auto& a, const auto& b) { return a.landmark < b.landmark; });
  held.landmarks.resize(positions.size() - held.problem.priors.size());
  adjust_bundle(world.options, &held.problem);
  EXPECT_LT(estimate_uncertainty(world.options, held).sigma_m, 0.7 * free_m);
}

// It may be off by much in a half, but that says little about the map.
TEST(MapUncertainty, AViewOfNextToNothingDoesNotDecide) {
  std::mt19937 rng(5);
  BundleWorld world = make_bundle_world(rng, room());
  const double before_m = estimate_uncertainty(world.options, adjust(world).extract).sigma_m;
  std::vector<BundleObservation> kept;
  std::uint32_t num_of_blind = 0;
  for (const BundleObservation& o : world.start.observations) {
    if (o.camera != 7)
      kept.push_back(o);
    else if (num_of_blind++ < 5)
      kept.push_back({o.camera, o.landmark, o.x, o.y, 0, o.sigma_px});
  }
  world.start.observations = kept;
  const Adjusted adjusted = adjust(world);
  EXPECT_LT(estimate_uncertainty(world.options, adjusted.extract).sigma_m, 1.3 * before_m);
}

TEST(MapUncertainty, ExactMeasurementsLeaveNone) {
  std::mt19937 rng(1);
  BundleWorldOptions options = room();
  options.noise_px = 0;
  BundleWorld world = make_bundle_world(rng, options);
  for (BundleObservation& o : world.start.observations) {
    const Eigen::Vector3d p = world.truth.T_map_camera[o.camera].inverse() * world.truth.landmarks_m[o.landmark];
    o.depth_m = static_cast<float>(p.z());
  }
  const MapUncertainty none = estimate_uncertainty(world.options, adjust(world).extract);
  EXPECT_LT(none.sigma_m, 1e-4);
  EXPECT_LT(none.sigma_rad, 1e-4);
}

TEST(MapUncertainty, AHandfulOfViewsSaysNothing) {
  std::mt19937 rng(1);
  BundleWorldOptions options = room();
  options.num_cameras = 3;
  const BundleWorld world = make_bundle_world(rng, options);
  const MapUncertainty unknown = estimate_uncertainty(world.options, adjust(world).extract);
  EXPECT_EQ(unknown.sigma_m, 0);
  EXPECT_EQ(unknown.sigma_rad, 0);
}

TEST(MapUncertainty, SameMapSameBits) {
  std::mt19937 rng(2);
  const BundleWorld world = make_bundle_world(rng, room());
  const MapExtract extract = adjust(world).extract;
  const MapUncertainty a = estimate_uncertainty(world.options, extract), b = estimate_uncertainty(world.options, extract);
  EXPECT_EQ(a.sigma_m, b.sigma_m);
  EXPECT_EQ(a.sigma_rad, b.sigma_rad);
  EXPECT_GT(a.sigma_m, 0);
}

}  // namespace
}  // namespace camloc
