// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// One landmark of two days.
#include "core/merge/landmark_merging.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

namespace camloc {
namespace {

/// A descriptor with its first `num_bits` bits set.
Descriptor descriptor(int num_bits) {
  Descriptor d{};
  auto* bytes = reinterpret_cast<std::uint8_t*>(&d);
  for (int i = 0; i < num_bits; ++i) bytes[i / 8] = static_cast<std::uint8_t>(bytes[i / 8] | (1U << (i % 8)));
  return d;
}

MapLandmark landmark(const Eigen::Vector3f& position_m, std::uint32_t num_observations, float sigma_m, int num_bits) {
  MapLandmark l;
  l.position_m = position_m;
  l.direction = Eigen::Vector3f::UnitX();
  l.view_cosine = 0.9F;
  l.min_reference_m = 1;
  l.max_reference_m = 2;
  l.position_sigma_m = sigma_m;
  l.num_observations = num_observations;
  l.descriptors = {descriptor(num_bits)};
  return l;
}

TEST(LandmarkMerging, PositionsAreWeighedByWhatIsKnownOfThem) {
  MapLandmark into = landmark({0, 0, 0}, 30, 0.01F, 0);
  std::vector<std::uint32_t> support{30};
  merge_landmark(landmark({0.04F, 0, 0}, 10, 0.01F, 10), {10}, &into, &support);
  EXPECT_NEAR(into.position_m.x(), 0.01F, 1e-6F);
  EXPECT_EQ(into.num_observations, 40U);
  EXPECT_GT(into.position_sigma_m, 0.0101F);  // the two maps do not agree
}

TEST(LandmarkMerging, AnotherLookIsKeptASimilarOneSupportsTheFirst) {
  MapLandmark into = landmark({0, 0, 0}, 5, 0.01F, 0);
  std::vector<std::uint32_t> support{5};
  EXPECT_EQ(merge_landmark(landmark({0, 0, 0}, 3, 0.01F, 48), {3}, &into, &support), 0U);
  EXPECT_EQ(support, std::vector<std::uint32_t>({8}));
  EXPECT_EQ(merge_landmark(landmark({0, 0, 0}, 9, 0.01F, 90), {9}, &into, &support), 1U);
  EXPECT_EQ(support, std::vector<std::uint32_t>({9, 8}));
  EXPECT_EQ(std::memcmp(&into.descriptors[0], &landmark({0, 0, 0}, 1, 1, 90).descriptors[0], sizeof(Descriptor)), 0);
}

TEST(LandmarkMerging, RangesAndTheConeOfViewsWiden) {
  MapLandmark into = landmark({0, 0, 0}, 5, 0.01F, 0), from = landmark({0, 0, 0}, 5, 0.01F, 0);
  from.min_reference_m = 0.5F;
  from.max_reference_m = 3;
  from.direction = Eigen::Vector3f(1, 1, 0).normalized();
  std::vector<std::uint32_t> support{5};
  merge_landmark(from, {5}, &into, &support);
  EXPECT_EQ(into.min_reference_m, 0.5F);
  EXPECT_EQ(into.max_reference_m, 3);
  EXPECT_LT(into.view_cosine, 0.9F);
  // Both mean directions are within the new cone.
  EXPECT_GE(into.direction.dot(from.direction), into.view_cosine - 1e-4F);
  EXPECT_GE(into.direction.x(), into.view_cosine - 1e-4F);
}

TEST(LandmarkMerging, TheGuessAtSupportAddsUpToTheObservations) {
  MapLandmark l = landmark({0, 0, 0}, 10, 0.01F, 0);
  l.descriptors = {descriptor(0), descriptor(80), descriptor(160)};
  const std::vector<std::uint32_t> support = guess_support(l);
  ASSERT_EQ(support.size(), 3U);
  EXPECT_GE(support[0], support[1]);
  EXPECT_GE(support[2], 1U);
}

}  // namespace
}  // namespace camloc
