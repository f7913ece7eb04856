// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What is said about a landmark once all views are in.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/features/hamming.h"
#include "core/mapmaking/landmark_fusion.h"
#include "tests/mapmaking/generated_view.h"

namespace camloc {
namespace {

TEST(LandmarkSummary, DescribesHowALandmarkWasSeen) {
  std::mt19937_64 random(12);
  const Descriptor descriptor{{random(), random(), random(), random()}};
  LandmarkFusion fusion(test_intrinsics(), {}, {});
  const Intrinsics k = test_intrinsics();
  for (const double x : {-0.4, 0.4}) {
    FrameFeatures view;
    view.T_map_camera = pose(x, 0, 0);
    const Eigen::Vector3d p = view.T_map_camera.inverse() * Eigen::Vector3d(0, 0, 2);
    add_feature(k, k.project(p), p.z(), x < 0 ? 0 : 2, descriptor, &view);
    fusion.add_view(view);
  }
  std::vector<std::vector<std::uint32_t>> support;
  const auto landmarks = fusion.landmarks(&support);
  ASSERT_EQ(landmarks.size(), 1U);
  const double distance = std::hypot(2.0, 0.4);
  EXPECT_EQ(landmarks[0].num_observations, 2U);
  EXPECT_NEAR(landmarks[0].min_reference_m, distance, 1e-3);
  EXPECT_NEAR(landmarks[0].max_reference_m, distance * 1.2 * 1.2, 1e-3);
  EXPECT_NEAR(landmarks[0].direction.z(), -1, 1e-3);
  EXPECT_NEAR(landmarks[0].view_cosine, 2 / distance, 1e-3);
  EXPECT_LT((landmarks[0].position_m - Eigen::Vector3f(0, 0, 2)).norm(), 1e-3F);
}

TEST(LandmarkSummary, KeepsASecondAppearanceAndPutsTheCommonOneFirst) {
  std::mt19937_64 random(16);
  const Descriptor rare{{random(), random(), random(), random()}};
  Descriptor common = rare;  // 56 bits away: the same landmark (up to 64), another appearance (more than 48)
  common.bits[0] ^= (std::uint64_t{1} << 56) - 1;
  LandmarkFusion fusion(test_intrinsics(), {}, {});
  for (int i = 0; i < 8; ++i) {
    FrameFeatures view;
    add_feature(test_intrinsics(), {320, 240}, 2, 0, flipped(i < 2 ? rare : common, 3, random), &view);
    fusion.add_view(view);
  }
  ASSERT_EQ(fusion.num_landmarks(), 1U);
  std::vector<std::vector<std::uint32_t>> support;
  const auto landmarks = fusion.landmarks(&support);
  ASSERT_EQ(landmarks[0].descriptors.size(), 2U);
  EXPECT_LE(hamming_distance(landmarks[0].descriptors[0], common), 4);
  EXPECT_LE(hamming_distance(landmarks[0].descriptors[1], rare), 4);
  EXPECT_EQ(support[0], (std::vector<std::uint32_t>{6, 2}));
}

// One point, seen from the same place at depths that scatter: the scatter of one observation, whatever their number.
TEST(LandmarkSummary, SigmaIsTheScatterOfOneObservation) {
  constexpr double kScatterM = 0.02;
  std::mt19937_64 random(21);
  std::normal_distribution<double> normal(0, kScatterM);
  for (const int num_views : {100, 400}) {
    LandmarkFusion fusion(test_intrinsics(), {}, {});
    for (int i = 0; i < num_views; ++i) {
      FrameFeatures view;
      add_feature(test_intrinsics(), {319.5, 239.5}, 2 + std::clamp(normal(random), -0.05, 0.05), 0, {}, &view);
      fusion.add_view(view);
    }
    ASSERT_EQ(fusion.num_landmarks(), 1U);
    std::vector<std::vector<std::uint32_t>> support;
    // One of three axes scatters.
    EXPECT_NEAR(fusion.landmarks(&support)[0].position_sigma_m, kScatterM / std::sqrt(3.0), 0.15 * kScatterM) << num_views;
  }
}

}  // namespace
}  // namespace camloc
