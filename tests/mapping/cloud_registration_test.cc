// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/mapping/cloud/cloud_registration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/mapping/scanned_flat.h"
#include "tools/mapping/cloud/cell_correlation.h"
#include "tools/mapping/cloud/wall_directions.h"

namespace camloc::mapping {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

Rigid3 motion(const Eigen::Vector3d& rotation_deg, const Eigen::Vector3d& translation_m) {
  return {exp_so3(kDegree * rotation_deg), translation_m};
}

/// Landmarks in a map whose frame differs from the cloud's by `T_cloud_map`.
std::vector<Eigen::Vector3d> in_map(const std::vector<Eigen::Vector3d>& landmarks, const Rigid3& T_cloud_map) {
  std::vector<Eigen::Vector3d> result;
  for (const Eigen::Vector3d& p : landmarks) result.push_back(T_cloud_map.inverse() * p);
  return result;
}

void expect_near(const Rigid3& T, const Rigid3& expected, double tolerance_m, double tolerance_deg) {
  EXPECT_LT((T * Eigen::Vector3d(4, 2, 1) - expected * Eigen::Vector3d(4, 2, 1)).norm(), tolerance_m);
  EXPECT_LT(rotation_distance_rad(T.rotation, expected.rotation), tolerance_deg * kDegree);
}

class Register : public ::testing::TestWithParam<int> {};

TEST_P(Register, RecoversAKnownTransform) {
  const ScannedFlat flat(40 + GetParam());
  Random random(static_cast<std::uint32_t>(GetParam()));
  const Rigid3 truth = motion(3 * random.direction(), 0.3 * random.direction());
  CloudIndex cloud(flat.cloud_m);
  const auto result = register_points(in_map(flat.landmarks_m, truth), &cloud, {}, {});
  ASSERT_TRUE(result.is_ok()) << result.status().message();
  EXPECT_TRUE(result.value().is_converged);
  expect_near(result.value().T_cloud_map.rigid, truth, 0.002, 0.03);
  EXPECT_EQ(result.value().T_cloud_map.scale, 1);
  EXPECT_GT(result.value().weakest_share, 0.05);
}

INSTANTIATE_TEST_SUITE_P(Seeds, Register, ::testing::Range(1, 6));

TEST(RegisterPoints, ShrugsOffWhatIsNotInTheCloud) {
  const ScannedFlat flat(1);
  const Rigid3 truth = motion({1, -1, 2}, {0.1, 0.2, -0.1});
  std::vector<Eigen::Vector3d> landmarks = flat.landmarks_m;
  Random random(5);
  for (std::size_t i = 0; i < landmarks.size(); i += 6) {  // chairs that were moved in
    landmarks[i] = {random.uniform(3, 5), random.uniform(2, 4), random.uniform(0.1, 1)};
  }
  CloudIndex cloud(flat.cloud_m);
  const auto result = register_points(in_map(landmarks, truth), &cloud, {}, {});
  ASSERT_TRUE(result.is_ok());
  expect_near(result.value().T_cloud_map.rigid, truth, 0.005, 0.1);
}

TEST(RegisterPoints, FindsTheScale) {
  const ScannedFlat flat(1);
  std::vector<Eigen::Vector3d> shrunk;
  for (const auto& p : flat.landmarks_m) shrunk.push_back(p / 1.03);
  CloudIndex cloud(flat.cloud_m);
  RegistrationOptions options;
  options.has_scale = true;
  const auto result = register_points(shrunk, &cloud, {}, options);
  ASSERT_TRUE(result.is_ok());
  EXPECT_NEAR(result.value().T_cloud_map.scale, 1.03, 0.002);
  EXPECT_GT(result.value().sigma_scale, 0);
  EXPECT_LT(result.value().sigma_scale, 0.002);
}

TEST(RegisterPoints, KnowsThatACorridorWithoutEndsSlides) {
  std::vector<Eigen::Vector3f> cloud_m;
  std::vector<Eigen::Vector3d> landmarks;
  Random random(3);
  for (int i = 0; i < 60000; ++i) {
    const double x = random.uniform(-10, 10), t = random.uniform(0, 2);
    const Eigen::Vector3d p = i % 2 == 0 ? Eigen::Vector3d(x, t, 0) : Eigen::Vector3d(x, i % 4 == 1 ? 0 : 2, t);
    cloud_m.push_back(p.cast<float>());
    if (i % 20 == 0 && std::abs(x) < 8) landmarks.push_back(p);
  }
  CloudIndex cloud(cloud_m);
  const auto result = register_points(landmarks, &cloud, {}, {});
  ASSERT_TRUE(result.is_ok());
  EXPECT_LT(result.value().weakest_share, 0.01);
  EXPECT_GT(std::abs(result.value().weakest_direction.x()), 0.99);
  EXPECT_LT(result.value().T_cloud_map.rigid.translation.norm(), 0.02);  // and does not run away
}

TEST(RegisterPoints, SaysThatNothingIsNear) {
  const ScannedFlat flat(1);
  CloudIndex cloud(flat.cloud_m);
  const auto result = register_points(flat.landmarks_m, &cloud, {1, motion({0, 0, 0}, {100, 0, 0})}, {});
  ASSERT_FALSE(result.is_ok());
  EXPECT_EQ(result.status().code(), ErrorCode::kInvalid);
}

class Search : public ::testing::TestWithParam<int> {};

TEST_P(Search, FindsAMapInAnyFrame) {
  const ScannedFlat flat(7);
  Random random(static_cast<std::uint32_t>(GetParam()));
  const Rigid3 truth{random.rotation(), 30 * random.direction()};
  auto landmarks = in_map(flat.landmarks_m, truth);
  // Odd ones hold only a part of the flat: one room and what is behind its door.
  if (GetParam() % 2 == 1) std::erase_if(landmarks, [&](const Eigen::Vector3d& p) { return (truth * p).x() > 5; });
  const auto starts = find_coarse_starts(landmarks, flat.cloud_m, Eigen::Vector3d::Zero());
  ASSERT_TRUE(starts.is_ok());
  ASSERT_GE(starts.value().size(), 2U);
  EXPECT_FALSE(starts.value()[0].is_identity);
  CloudIndex cloud(flat.cloud_m);
  RegistrationOptions options;
  options.start_distance_m = 1.5;
  options.max_points = 3000;
  Rigid3 best;
  double best_score = 1e9;
  for (const CoarseStart& start : starts.value()) {
    const auto result = register_points(landmarks, &cloud, {1, start.T_cloud_map}, options);
    if (!result.is_ok()) continue;
    const double score = capped_mean_distance(landmarks, cloud, result.value().T_cloud_map.rigid, 0.5);
    if (score < best_score) best_score = score, best = result.value().T_cloud_map.rigid;
  }
  expect_near(best * truth.inverse(), Rigid3{}, 0.01, 0.1);
}

INSTANTIATE_TEST_SUITE_P(Seeds, Search, ::testing::Range(1, 7));

TEST(CoarseStarts, KeepTheMapsOwnFrameWhereItFits) {
  const ScannedFlat flat(7);
  std::vector<Eigen::Vector3d> landmarks;
  const Eigen::Vector3d origin(500000, 5400000, 100);  // the cloud is relative to it, the map is not
  for (const auto& p : flat.landmarks_m) landmarks.push_back(p + origin);
  const auto starts = find_coarse_starts(landmarks, flat.cloud_m, origin);
  ASSERT_TRUE(starts.is_ok());
  EXPECT_TRUE(starts.value()[0].is_identity);
  expect_near(starts.value()[0].T_cloud_map * Rigid3{Eigen::Quaterniond::Identity(), origin}, Rigid3{}, 1e-6, 1e-6);
  EXPECT_FALSE(find_coarse_starts(std::vector<Eigen::Vector3d>(100, Eigen::Vector3d(1, 2, 3)), flat.cloud_m, origin).is_ok());
}

TEST(WallDirections, AreThoseOfTheRoom) {
  const ScannedFlat flat(2);
  const Rigid3 turn = motion({20, 30, 40}, {0, 0, 0});
  std::vector<Eigen::Vector3d> points;
  for (std::size_t i = 0; i < flat.cloud_m.size(); i += 7) points.push_back(turn * flat.cloud_m[i].cast<double>());
  const Eigen::Matrix3d axes = turn.rotation.toRotationMatrix().transpose() * wall_directions(points);
  EXPECT_NEAR(axes.determinant(), 1, 1e-9);
  for (int i = 0; i < 3; ++i) EXPECT_GT(axes.col(i).cwiseAbs().maxCoeff(), 0.9998) << axes;
}

TEST(CellGridTest, FindsWhereAPieceBelongs) {
  Random random(1);
  std::vector<Eigen::Vector3d> points, piece;
  for (int i = 0; i < 400; ++i) points.emplace_back(random.uniform(-10, 10), random.uniform(-8, 8), random.uniform(0, 3));
  for (const auto& p : points)
    if (p.x() > 2) piece.push_back(p - Eigen::Vector3d(7, -20, 100));
  const CellGrid grid(points, 0.25, 1000000);
  const auto places = grid.best_places(piece, 4);
  ASSERT_EQ(places.size(), 4U);
  EXPECT_LT((places[0].translation_m - Eigen::Vector3d(7, -20, 100)).cwiseAbs().maxCoeff(), 0.26);
  EXPECT_GT(places[0].share, 2 * places[1].share);
  EXPECT_EQ(CellGrid(points, 0.25, 1000).cell_m() > 0.5, true);
  EXPECT_TRUE(grid.best_places({}, 3).empty());
}

}  // namespace
}  // namespace camloc::mapping
