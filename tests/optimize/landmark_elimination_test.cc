// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// One landmark: what the terms of its observations say against differences, its elimination against the whole system.
#include "core/optimize/landmark_elimination.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <limits>

#include "core/geometry/pose_jacobian.h"
#include "tests/geometry/generated.h"

namespace camloc {
namespace {

/// A landmark seen by a fixed camera and by two free ones, so noisily that some residuals are beyond the kernels.
struct Sight {
  BundleOptions options;
  std::vector<Rigid3> T_map_camera;
  std::vector<BundleObservation> observations;
  std::vector<PointPrior> priors;
  Eigen::Vector3d X;

  explicit Sight(std::mt19937& rng) : X(testing::random_vector(rng, 1)) {
    for (std::uint32_t i = 0; i < 3; ++i) {
      const Eigen::Vector3d p(0.3 * i - 0.2, 0.2 - 0.1 * i, 1.5 + 0.4 * i);
      const Rigid3 random = testing::random_pose(rng, 1);
      T_map_camera.push_back({random.rotation, X - random.rotation * p});
      const Eigen::Vector3d noise = testing::random_vector(rng, 1);
      observations.push_back({i, 0, static_cast<float>(p.x() / p.z() + noise.x() * 3 / options.focal_px),
                              static_cast<float>(p.y() / p.z() + noise.y() * 3 / options.focal_px),
                              i == 1 ? 0.0F : static_cast<float>(p.z() + 0.05 * noise.z()), 1.5F});
    }
    priors.push_back({0, X + testing::random_vector(rng, 0.02), 0.03});
  }

  [[nodiscard]] LandmarkObservations landmark() const { return {observations, priors}; }

  /// Cost after a change of (camera 1, camera 2, landmark).
  [[nodiscard]] double cost(const Eigen::VectorXd& change) const {
    const std::vector<BundleCamera> cameras{{T_map_camera[0], kFixedPose},
                                            {moved_in_camera_axes(T_map_camera[1], change.head<6>()), 0},
                                            {moved_in_camera_axes(T_map_camera[2], change.segment<6>(6)), 1}};
    return LandmarkEliminator(options, cameras).cost(landmark(), X + change.tail<3>());
  }
};

/// Half the gradient of the cost by differences.
Eigen::VectorXd gradient(const Sight& sight, const Eigen::VectorXd& at) {
  constexpr double kStep = 1e-6;
  Eigen::VectorXd g(15);
  for (int k = 0; k < 15; ++k) {
    const Eigen::VectorXd step = kStep * Eigen::VectorXd::Unit(15, k);
    g[k] = 0.5 * (sight.cost(at + step) - sight.cost(at - step)) / (2 * kStep);
  }
  return g;
}

TEST(LandmarkElimination, StepIsThatOfTheWholeSystem) {
  std::mt19937 rng(1);
  for (int i = 0; i < 20; ++i) {
    const Sight sight(rng);
    const std::vector<BundleCamera> cameras{{sight.T_map_camera[0], kFixedPose}, {sight.T_map_camera[1], 0}, {sight.T_map_camera[2], 1}};
    // The whole Gauss-Newton matrix from residuals by differences, weighted as the kernels weight.
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(15, 15);
    Eigen::VectorXd g = Eigen::VectorXd::Zero(15);
    for (const BundleObservation& o : sight.observations) {
      const auto residuals = [&](const Eigen::VectorXd& change) -> Eigen::Vector3d {
        Rigid3 T = sight.T_map_camera[o.camera];
        if (o.camera > 0) T = moved_in_camera_axes(T, change.segment<6>(6 * (o.camera - 1)));
        const Eigen::Vector3d X = sight.X + change.tail<3>();
        const BundleCamera camera(T, 0);
        const SeenLandmark seen(o, camera, X.data());
        return {ReprojectionTerm(sight.options, o, seen).residual[0], ReprojectionTerm(sight.options, o, seen).residual[1],
                DepthTerm(sight.options, o, seen).residual[0]};
      };
      const SeenLandmark seen(o, cameras[o.camera], sight.X.data());
      const double pixel_weight = ReprojectionTerm(sight.options, o, seen).weight;
      const Eigen::Vector3d weights(pixel_weight, pixel_weight, DepthTerm(sight.options, o, seen).weight);
      Eigen::MatrixXd J(3, 15);
      for (int k = 0; k < 15; ++k) {
        const Eigen::VectorXd step = 1e-6 * Eigen::VectorXd::Unit(15, k);
        J.col(k) = (residuals(step) - residuals(-step)) / 2e-6;
      }
      H += J.transpose() * weights.asDiagonal() * J;
      g += J.transpose() * weights.asDiagonal() * residuals(Eigen::VectorXd::Zero(15));
    }
    const PointPrior& prior = sight.priors[0];
    const double weight = 1 / (prior.sigma_m * prior.sigma_m);
    H.bottomRightCorner<3, 3>() += weight * Eigen::Matrix3d::Identity();
    g.tail<3>() += weight * (sight.X - prior.position_m);
    // The kernels' weights make it the gradient of the robust cost.
    EXPECT_LT((g - gradient(sight, Eigen::VectorXd::Zero(15))).norm(), 1e-5 * g.norm());

    BlockSystem reduced(2);
    LandmarkEliminator eliminator(sight.options, cameras);
    const double cost = eliminator.eliminate(sight.landmark(), sight.X, 0.0, &reduced);
    EXPECT_NEAR(cost, sight.cost(Eigen::VectorXd::Zero(15)), 1e-9 * cost);
    const Eigen::Matrix3d C_inverse = H.bottomRightCorner<3, 3>().inverse();
    const Eigen::MatrixXd S = H.topLeftCorner(12, 12) - H.topRightCorner(12, 3) * C_inverse * H.bottomLeftCorner(3, 12);
    const Eigen::VectorXd s = g.head(12) - H.topRightCorner(12, 3) * C_inverse * g.tail<3>();
    for (std::uint32_t column = 0; column < 2; ++column) {
      EXPECT_LT((reduced.diagonal(column) - H.diagonal().segment<6>(6 * column)).norm(), 1e-6 * H.norm());
      EXPECT_LT((reduced.gradient(column) - s.segment<6>(6 * column)).norm(), 1e-6 * g.norm());
      for (std::uint32_t row = 0; row <= column; ++row) {
        const Eigen::Map<const Matrix6d> block(reduced.block(row, column));
        EXPECT_LT((block - S.block<6, 6>(6 * row, 6 * column)).norm(), 1e-6 * H.norm());
      }
    }
    const std::vector<Vector6d> steps{Vector6d::Constant(0.001), Vector6d::Constant(-0.002)};
    Eigen::VectorXd d(12);
    d << steps[0], steps[1];
    const Eigen::Vector3d expected = -C_inverse * (g.tail<3>() + H.bottomLeftCorner(3, 12) * d);
    EXPECT_LT((eliminator.step(sight.landmark(), sight.X, 0.0, steps) - expected).norm(), 1e-6 * (1 + expected.norm()));
  }
}

/// Every term's derivatives by pose and landmark against differences of its residuals.
template <class Term>
void expect_true_derivatives(const Sight& sight) {
  for (const BundleObservation& o : sight.observations) {
    const auto residual = [&](const Vector6d& by_pose, const Eigen::Vector3d& by_landmark, int row) {
      const BundleCamera camera(moved_in_camera_axes(sight.T_map_camera[o.camera], by_pose), 0);
      const Eigen::Vector3d X = sight.X + by_landmark;
      return Term(sight.options, o, SeenLandmark(o, camera, X.data())).residual[row];
    };
    const BundleCamera camera(sight.T_map_camera[o.camera], 0);
    const SeenLandmark seen(o, camera, sight.X.data());
    if (Term(sight.options, o, seen).weight == 0) continue;
    for (int row = 0; row < Term::kRows; ++row) {
      for (int k = 0; k < 6; ++k) {
        const Vector6d step = 1e-6 * Vector6d::Unit(k);
        const double difference = (residual(step, Eigen::Vector3d::Zero(), row) - residual(-step, Eigen::Vector3d::Zero(), row)) / 2e-6;
        EXPECT_NEAR(Term::by_pose(seen)(k, row), difference, 1e-7) << "row " << row << " by " << k;
      }
      for (int axis = 0; axis < 3; ++axis) {
        const Eigen::Vector3d step = 1e-6 * Eigen::Vector3d::Unit(axis);
        const double difference = (residual(Vector6d::Zero(), step, row) - residual(Vector6d::Zero(), -step, row)) / 2e-6;
        EXPECT_NEAR(Term::by_landmark(axis, seen)[static_cast<std::size_t>(row)] * Term::landmark_scale(seen), difference, 1e-7);
      }
    }
  }
}

TEST(ObservationTerms, DerivativesAgreeWithDifferences) {
  std::mt19937 rng(2);
  for (int i = 0; i < 20; ++i) {
    const Sight sight(rng);
    expect_true_derivatives<ReprojectionTerm>(sight);
    expect_true_derivatives<DepthTerm>(sight);
  }
}

TEST(Kernels, HuberIsQuadraticInsideAndLinearOutside) {
  EXPECT_EQ(huber(4, 2).cost, 4);
  EXPECT_EQ(huber(4, 2).weight, 1);
  EXPECT_DOUBLE_EQ(huber(100, 2).cost, 2 * 2 * 10 - 4);
  EXPECT_DOUBLE_EQ(huber(100, 2).weight, 0.2);
}

TEST(Kernels, CauchyLetsGoOfWhatIsFarAndLeavesOutWhatIsNotFinite) {
  EXPECT_DOUBLE_EQ(cauchy(3, 0).cost, 3);
  EXPECT_DOUBLE_EQ(cauchy(3, 0).weight, 1);
  EXPECT_NEAR(cauchy(1e-6, 2).cost, 1e-6, 1e-12);
  EXPECT_DOUBLE_EQ(cauchy(400, 2).weight, 1.0 / 101);
  for (const double width : {0.0, 2.0}) {
    EXPECT_EQ(cauchy(std::numeric_limits<double>::infinity(), width).weight, 0);
    EXPECT_EQ(cauchy(std::numeric_limits<double>::quiet_NaN(), width).cost, 0);
  }
}

TEST(ObservationTerms, CostBehindTheCameraIsThatAt45Degrees) {
  const BundleOptions options;
  const BundleCamera camera(Rigid3{}, 0);
  const BundleObservation observation{0, 0, 0, 0, 1, 1};
  const auto cost = [&](const double X[3]) { return ObservationTerms(options, observation, SeenLandmark(observation, camera, X)).cost(); };
  const double at_45[] = {0.999999, 0, 1.0}, beyond[] = {3, 0, 1.0}, behind[] = {0, 0, -1};
  EXPECT_NEAR(cost(at_45), cost(behind), 0.01);
  EXPECT_EQ(cost(beyond), cost(behind));
  const SeenLandmark out(observation, camera, behind);
  EXPECT_FALSE(out.is_in_view);
  EXPECT_EQ(ReprojectionTerm(options, observation, out).weight, 0);
  EXPECT_EQ(DepthTerm(options, observation, out).weight, 0);
}

}  // namespace
}  // namespace camloc
