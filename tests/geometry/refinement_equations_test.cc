// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The vectorized sums against a plain loop over rows of the Jacobian.
#include "core/geometry/refinement_equations.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/geometry/pose_jacobian.h"
#include "tests/geometry/generated.h"

namespace camloc {
namespace {

using Equations = NormalEquations<7>;
using Row = Eigen::Matrix<double, 7, 1>;

struct Loss {
  double cost, weight;
};

Loss loss_of(const RefinementModel& model, double squared, double reach) {
  const double c2 = model.cauchy_scale * model.cauchy_scale;
  const bool is_near = squared <= reach * reach;
  const double limited = is_near ? squared : reach * reach;
  if (model.kernel == RobustKernel::kTruncated) return {limited, is_near ? 1.0 : 0.0};
  return {c2 * std::log1p(limited / c2), is_near ? 1.0 / (1.0 + limited / c2) : 0.0};
}

void add_row(const Row& row, double residual, double weight, Equations* equations) {
  equations->gradient += weight * residual * row;
  equations->hessian += weight * row * row.transpose();
}

Equations plain_equations(const Correspondences& pairs, const RefinementModel& model, const Rigid3& T_map_camera, double focal_scale) {
  Equations equations;
  const double scale = model.focal_px * focal_scale;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Eigen::Vector3d p = T_map_camera.inverse() * Eigen::Vector3d(pairs.X[i], pairs.Y[i], pairs.Z[i]);
    const double u = p.x() / p.z(), v = p.y() / p.z();
    const double du = scale * u - model.focal_px * pairs.x[i], dv = scale * v - model.focal_px * pairs.y[i];
    const double sigma = pairs.sigma_px[i], reach = model.reach_px / sigma;
    const double infinity = std::numeric_limits<double>::infinity();
    const bool is_in_front = p.z() > kMinRefinementDepth_m;
    const Loss pixel = loss_of(model, is_in_front ? (du * du + dv * dv) / (sigma * sigma) : infinity, reach);
    equations.cost += pixel.cost;
    const bool has_depth = model.use_depth && pairs.depth_m[i] > 0;
    const double depth_sigma = model.depth_noise.sigma_m(pairs.depth_m[i]), dz = p.z() - pairs.depth_m[i];
    Loss depth{0, 0};
    if (has_depth) depth = loss_of(model, pixel.weight > 0 ? dz * dz / (depth_sigma * depth_sigma) : infinity, model.reach_depth_sigmas);
    equations.cost += depth.cost;
    if (!(pixel.weight > 0)) continue;
    const PointJacobian J = point_jacobian(u, v, p.z());
    Row row_u, row_v, row_z;
    row_u << scale * J.u, model.focal_px * u;
    row_v << scale * J.v, model.focal_px * v;
    row_z << J.z, 0;
    add_row(row_u, du, pixel.weight / (sigma * sigma), &equations);
    add_row(row_v, dv, pixel.weight / (sigma * sigma), &equations);
    if (depth.weight > 0) add_row(row_z, dz, depth.weight / (depth_sigma * depth_sigma), &equations);
  }
  return equations;
}

class RefinementEquations : public ::testing::TestWithParam<RobustKernel> {
 protected:
  RefinementEquations() {
    model_.focal_px = 525;
    model_.kernel = GetParam();
    scene_options_.outlier_ratio = 0.3;
  }
  std::mt19937 rng_{31};
  RefinementModel model_;
  testing::SceneOptions scene_options_;
};

TEST_P(RefinementEquations, AgreeWithAPlainLoopForEverySize) {
  for (const int n : {1, 2, 3, 4, 5, 63, 64, 65, 130, 200}) {
    scene_options_.num_pairs = n;
    testing::Scene scene = make_scene(rng_, scene_options_);
    for (std::size_t i = 0; i < scene.pairs.size(); ++i) {
      scene.pairs.sigma_px[i] = 1.0F + 0.2F * static_cast<float>(i % 5);
      if (i % 3 == 0) scene.pairs.depth_m[i] = 0;
    }
    for (const bool use_depth : {true, false}) {
      model_.use_depth = use_depth;
      const Rigid3 at = testing::disturbed(rng_, scene.T_map_camera, 0.02, 0.005);
      const Equations expected = plain_equations(scene.pairs, model_, at, 1.1);
      const Equations seven = normal_equations<7>(scene.pairs, model_, at, 1.1);
      EXPECT_NEAR(seven.cost, expected.cost, 1e-10 * expected.cost) << n;
      EXPECT_LE((seven.gradient - expected.gradient).norm(), 1e-10 * (1 + expected.gradient.norm())) << n;
      EXPECT_LE((seven.hessian - expected.hessian).norm(), 1e-10 * (1 + expected.hessian.norm())) << n;
      const NormalEquations<6> six = normal_equations<6>(scene.pairs, model_, at, 1.1);
      EXPECT_EQ(six.cost, seven.cost);
      EXPECT_EQ(six.gradient, seven.gradient.head<6>());
      EXPECT_EQ(six.hessian, (seven.hessian.topLeftCorner<6, 6>()));
    }
  }
}

TEST_P(RefinementEquations, PairsBehindOrNotANumberCountAsOutOfReach) {
  scene_options_.num_pairs = 20;
  const testing::Scene scene = make_scene(rng_, scene_options_);
  Correspondences spoilt(scene.pairs.size() + 3);
  for (std::size_t i = 0; i < scene.pairs.size(); ++i)
    spoilt.add(scene.pairs.x[i], scene.pairs.y[i], scene.pairs.X[i], scene.pairs.Y[i], scene.pairs.Z[i], 0, 1, 0, 0, 0);
  const Rigid3& at = scene.T_map_camera;
  const Equations good = normal_equations<7>(spoilt, model_, at, 1.0);
  const Eigen::Vector3f behind = (at * Eigen::Vector3d(0.1, 0.1, -1)).cast<float>();
  const Eigen::Vector3f beside = at.translation.cast<float>();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  spoilt.add(0.1F, 0.1F, behind.x(), behind.y(), behind.z(), 1, 1, 0, 0, 0);
  spoilt.add(0, 0, beside.x(), beside.y(), beside.z(), 0, 1, 0, 0, 0);
  spoilt.add(nan, 0, nan, 0, 2, nan, 1, 0, 0, 0);
  const Equations with_bad = normal_equations<7>(spoilt, model_, at, 1.0);
  EXPECT_TRUE(with_bad.hessian.allFinite());
  EXPECT_LE((with_bad.gradient - good.gradient).norm(), 1e-10 * good.gradient.norm());
  EXPECT_LE((with_bad.hessian - good.hessian).norm(), 1e-10 * good.hessian.norm());
  EXPECT_GT(with_bad.cost, good.cost);
}

INSTANTIATE_TEST_SUITE_P(Kernels, RefinementEquations, ::testing::Values(RobustKernel::kCauchy, RobustKernel::kTruncated));

}  // namespace
}  // namespace camloc
