// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Where a map lies in a scan, found without a hint.
#include <gtest/gtest.h>

#include "tests/mapping/motions.h"
#include "tests/mapping/scanned_flat.h"
#include "tools/mapping/cloud/cloud_registration.h"

namespace camloc::mapping {
namespace {

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

}  // namespace
}  // namespace camloc::mapping
