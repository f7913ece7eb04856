// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "tests/mapping/scanned_flat.h"
#include "tools/mapping/cloud/cloud_registration.h"

namespace camloc::mapping {
namespace {

/// A floor of 10 x 10 m, a point every 2 cm.
std::vector<Eigen::Vector3f> scanned_floor() {
  std::vector<Eigen::Vector3f> cloud;
  for (int i = 0; i <= 500; ++i) {
    for (int k = 0; k <= 500; ++k) cloud.emplace_back(0.02F * static_cast<float>(i), 0.02F * static_cast<float>(k), 0.0F);
  }
  return cloud;
}

TEST(Statistics, AreWhatTheyShouldBe) {
  std::vector<float> values;
  for (int i = 1; i <= 100; ++i) values.push_back(0.001F * static_cast<float>(101 - i));
  const DistanceStatistics s = statistics_of(values);
  EXPECT_EQ(s.count, 100U);
  EXPECT_NEAR(s.mean_m, 0.0505, 1e-6);
  EXPECT_NEAR(s.median_m, 0.051, 1e-6);
  EXPECT_NEAR(s.p95_m, 0.095, 1e-6);
  EXPECT_NEAR(s.max_m, 0.1, 1e-6);
  EXPECT_NEAR(s.rms_m, std::sqrt(338350.0 / 100) * 0.001, 1e-6);
  EXPECT_NEAR(s.share_3cm, 0.30, 0.011);
  EXPECT_NEAR(s.share_5cm, 0.50, 0.011);
  EXPECT_EQ(statistics_of({}).count, 0U);
}

TEST(Distances, SeparatePointAndSurface) {
  const auto cloud_m = scanned_floor();
  CloudIndex cloud(cloud_m);
  // 4 cm above the floor, in the middle between four points.
  std::vector<Eigen::Vector3d> landmarks;
  for (int i = 50; i < 450; ++i) landmarks.emplace_back(0.02 * i + 0.01, 0.02 * (500 - i) + 0.01, 0.04);
  const CloudDistances d = measure_distances(landmarks, {}, &cloud, 0.5);
  EXPECT_NEAR(d.point.mean_m, std::sqrt(0.04 * 0.04 + 2 * 0.01 * 0.01), 1e-5);
  EXPECT_NEAR(d.plane.mean_m, 0.04, 1e-5);
  EXPECT_EQ(d.point.share_3cm, 0);
  EXPECT_EQ(d.point.share_5cm, 1);
  EXPECT_EQ(d.num_outside, 0U);
}

TEST(Distances, KeepWhatIsOutsideApart) {
  const auto cloud_m = scanned_floor();
  CloudIndex cloud(cloud_m);
  std::vector<Eigen::Vector3d> landmarks(9, Eigen::Vector3d(5, 5, 0.01));
  landmarks.emplace_back(5, 5, 3);
  const CloudDistances d = measure_distances(landmarks, {}, &cloud, 0.5);
  EXPECT_EQ(d.num_outside, 1U);
  EXPECT_EQ(d.point.count, 9U);
  EXPECT_NEAR(d.point.mean_m, 0.01, 1e-4);
  EXPECT_EQ(d.all.count, 10U);
  EXPECT_NEAR(d.all.mean_m, 0.309, 1e-3);
  ASSERT_EQ(d.point_m.size(), 10U);
  EXPECT_NEAR(d.point_m[9], 3, 1e-5);
}

TEST(Distances, CountCoverageWhereTheMapIs) {
  const auto cloud_m = scanned_floor();
  CloudIndex cloud(cloud_m);
  // The left half of the floor densely, of the right half only a strip far away.
  std::vector<Eigen::Vector3d> landmarks;
  for (double x = 0; x < 5; x += 0.1)
    for (double y = 0; y < 10; y += 0.1) landmarks.emplace_back(x, y, 0);
  for (double y = 0; y < 10; y += 0.02) landmarks.emplace_back(10, y, 0);
  CloudDistances d = measure_distances(landmarks, {}, &cloud, 0.5);
  EXPECT_NEAR(static_cast<double>(d.num_cells), 1600, 90);
  EXPECT_NEAR(static_cast<double>(d.num_covered) / static_cast<double>(d.num_cells), 0.54, 0.03);
  EXPECT_GT(d.cells.max_m, 2);
  // Only what a camera was near to can be expected.
  d = measure_distances(landmarks, std::vector<Eigen::Vector3d>{{2, 5, std::sqrt(5 * 5 - 3)}}, &cloud, 0.5);  // 5 m reach a disc
  EXPECT_EQ(d.num_covered, d.num_cells);
  EXPECT_NEAR(static_cast<double>(d.num_cells), M_PI * 3 * 16, 15);
}

TEST(Distances, ShowACollapsedMapByItsVolumeAndCoverage) {
  const ScannedFlat flat(1);
  CloudIndex cloud(flat.cloud_m);
  std::vector<Eigen::Vector3d> collapsed;  // all on one corner of the room: each landmark is on the cloud
  for (const auto& p : flat.landmarks_m) collapsed.push_back(0.001 * p);
  const CloudDistances good = measure_distances(flat.landmarks_m, {}, &cloud, 0.5), bad = measure_distances(collapsed, {}, &cloud, 0.5);
  EXPECT_LT(bad.point.mean_m, 0.03);
  EXPECT_LT(bad.volume_ratio(), 1e-4);
  EXPECT_NEAR(good.volume_ratio(), 1, 0.1);
  EXPECT_GT(static_cast<double>(good.num_covered) / static_cast<double>(good.num_cells), 0.9);
}

}  // namespace
}  // namespace camloc::mapping
