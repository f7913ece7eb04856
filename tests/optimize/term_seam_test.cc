// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The seam of terms: one that no other file knows joins a bundle adjustment, and the optimum obeys it.
#include <gtest/gtest.h>

#include "core/optimize/bundle_adjustment.h"
#include "core/optimize/terms/pose_terms.h"
#include "tests/geometry/generated.h"
#include "tests/optimize/generated_bundle.h"
#include "tests/optimize/pose_term_derivatives.h"

namespace camloc {
namespace {

/// The centre of a camera lies on a plane, as that of a robot does: residual (normal . centre - offset) / sigma.
struct OnPlaneTerm {
  static constexpr int kRows = 1, kPoses = 1;

  std::uint32_t camera = 0;
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double offset_m = 0, sigma_m = 1e-4;

  [[nodiscard]] std::array<std::uint32_t, 1> poses() const { return {camera}; }
  [[nodiscard]] PoseResidual<1, 1> linearize(const std::array<Rigid3, 1>& T_map_camera) const {
    PoseResidual<1, 1> term;
    term.residual[0] = (normal.dot(T_map_camera[0].translation) - offset_m) / sigma_m;
    term.J[0].setZero();
    term.J[0].head<3>() = normal.transpose() * T_map_camera[0].rotation.toRotationMatrix() / sigma_m;
    return term;
  }
};

TEST(TermSeam, DerivativesAgreeWithDifferences) {
  std::mt19937 rng(1);
  for (int i = 0; i < 20; ++i) {
    const OnPlaneTerm term{0, testing::random_vector(rng, 1), 0.3, 0.1};
    testing::expect_true_derivatives(term, std::array{testing::random_pose(rng, 2)});
  }
}

TEST(TermSeam, ATermOfItsOwnIsObeyed) {
  for (const std::uint32_t max_dense_cameras : {250U, 0U}) {
    std::mt19937 rng(2);
    testing::BundleWorld world = testing::make_bundle_world(rng, {});
    world.options.max_dense_cameras = max_dense_cameras;
    // Without the term, each camera is off its true height by what its landmarks are noisy.
    BundleProblem without = world.start, with = world.start;
    std::vector<OnPlaneTerm> terms;
    for (std::uint32_t i = 0; i < with.T_map_camera.size(); ++i)
      terms.push_back({i, Eigen::Vector3d::UnitZ(), world.truth.T_map_camera[i].translation.z()});
    const PoseTermsOf<OnPlaneTerm> block(terms, 0);
    with.pose_terms = {&block};
    adjust_bundle(world.options, &without);
    const BundleReport report = adjust_bundle(world.options, &with);
    EXPECT_EQ(report.is_sparse, max_dense_cameras == 0);
    const auto height_error_m = [&](const BundleProblem& problem) {
      double worst = 0;
      for (std::size_t i = 0; i < terms.size(); ++i)
        worst = std::max(worst, std::abs(problem.T_map_camera[i].translation.z() - terms[i].offset_m));
      return worst;
    };
    EXPECT_GT(height_error_m(without), 1e-3);
    EXPECT_LT(height_error_m(with), 1e-4);
    EXPECT_LT(testing::camera_error_m(with, world.truth), testing::camera_error_m(without, world.truth));
  }
}

TEST(TermSeam, AKernelLetsGoOfATermThatIsWrong) {
  std::mt19937 rng(3);
  testing::BundleWorld world = testing::make_bundle_world(rng, {});
  BundleProblem without = world.start, with = world.start;
  const std::vector<OnPlaneTerm> wrong = {{5, Eigen::Vector3d::UnitZ(), world.truth.T_map_camera[5].translation.z() + 1, 0.01}};
  const PoseTermsOf<OnPlaneTerm> block(wrong, 2);
  with.pose_terms = {&block};
  adjust_bundle(world.options, &without);
  adjust_bundle(world.options, &with);
  EXPECT_LT(testing::camera_error_m(with, without), 1e-3);
}

}  // namespace
}  // namespace camloc
