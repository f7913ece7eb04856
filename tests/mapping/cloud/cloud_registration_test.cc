// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/mapping/cloud/cloud_registration.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/mapping/motions.h"
#include "tests/mapping/scanned_flat.h"

namespace camloc::mapping {
namespace {

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

}  // namespace
}  // namespace camloc::mapping
