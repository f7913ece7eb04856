// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/hamming.h"

#include <gtest/gtest.h>

#include <bitset>
#include <opencv2/core.hpp>
#include <random>

#include "core/features/hamming_kernels.h"

namespace camloc {
namespace {

/// `num_random_bits` of the 256 are random; the fewer there are, the more distances are equal.
std::vector<Descriptor> random_descriptors(std::size_t count, int num_random_bits, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<Descriptor> descriptors(count);
  for (Descriptor& descriptor : descriptors)
    for (int i = 0; i < num_random_bits; ++i) descriptor.bits[static_cast<std::size_t>(i % 4)] |= (random() & 1) << (i * 7 % 64);
  return descriptors;
}

int distance_by_bits(const Descriptor& a, const Descriptor& b) {
  std::size_t sum = 0;
  for (std::size_t k = 0; k < 4; ++k) sum += std::bitset<64>(a.bits[k] ^ b.bits[k]).count();
  return static_cast<int>(sum);
}

NearestDescriptor nearest_by_definition(const Descriptor& query, const std::vector<Descriptor>& train) {
  NearestDescriptor nearest;
  for (std::size_t i = 0; i < train.size(); ++i)
    if (const int distance = distance_by_bits(query, train[i]); distance < nearest.distance)
      nearest = {static_cast<std::uint32_t>(i), static_cast<std::uint16_t>(distance), 257};
  for (std::size_t i = 0; i < train.size(); ++i)
    if (i != nearest.index) nearest.second = std::min(nearest.second, static_cast<std::uint16_t>(distance_by_bits(query, train[i])));
  return nearest;
}

TEST(Hamming, DistanceCountsDifferingBits) {
  Descriptor zeros, ones, one_bit;
  ones.bits = {~0ULL, ~0ULL, ~0ULL, ~0ULL};
  one_bit.bits[3] = 1ULL << 63;
  EXPECT_EQ(hamming_distance(zeros, zeros), 0);
  EXPECT_EQ(hamming_distance(zeros, ones), 256);
  EXPECT_EQ(hamming_distance(one_bit, zeros), 1);
  EXPECT_EQ(hamming_distance(one_bit, ones), 255);
  const auto descriptors = random_descriptors(50, 256, 1);
  for (const Descriptor& a : descriptors)
    for (const Descriptor& b : descriptors)
      EXPECT_EQ(hamming_distance(a, b), cv::norm(cv::Mat(1, 32, CV_8U, const_cast<std::uint64_t*>(a.bits.data())),
                                                 cv::Mat(1, 32, CV_8U, const_cast<std::uint64_t*>(b.bits.data())), cv::NORM_HAMMING));
}

TEST(Hamming, DistancesFillsWhatItPromisesAndNoMore) {
  const auto train = random_descriptors(70, 256, 2);
  const auto query = random_descriptors(1, 256, 3)[0];
  for (std::size_t count = 0; count <= train.size(); ++count) {
    std::vector<std::uint16_t> distances(train.size() + 1, 999);
    hamming_distances(query, {train.data(), count}, distances.data());
    for (std::size_t i = 0; i < distances.size(); ++i) ASSERT_EQ(distances[i], i < count ? distance_by_bits(query, train[i]) : 999);
  }
}

TEST(Hamming, UsesTheBestOfTheAvailableKernels) {
  const auto kernels = hamming::available_kernels();
  EXPECT_STREQ(kernels.front()->name, "scalar");
  EXPECT_STREQ(kernels.back()->name, hamming_kernel_name());
}

class HammingKernelTest : public ::testing::TestWithParam<const hamming::Kernels*> {};

TEST_P(HammingKernelTest, FindsNearestAndSecondAtAllSizes) {
  for (const std::size_t num_train : {0, 1, 2, 7, 15, 16, 17, 31, 32, 100, 511, 512, 513, 1040})
    for (const std::size_t num_queries : {1, 2, 3, 4, 5, 63, 64, 65, 130}) {
      const auto train = random_descriptors(num_train, 256, num_train + 1);
      const auto queries = random_descriptors(num_queries, 256, num_queries + 1000);
      std::vector<NearestDescriptor> nearest(num_queries + 1, {7, 7, 7});
      hamming::nearest_descriptors(*GetParam(), queries, train, nearest.data());
      for (std::size_t q = 0; q < num_queries; q += 1 + num_queries / 20) {
        const NearestDescriptor expected = nearest_by_definition(queries[q], train);
        ASSERT_EQ(nearest[q].index, expected.index) << num_train << " train, query " << q << " of " << num_queries;
        ASSERT_EQ(nearest[q].distance, expected.distance);
        ASSERT_EQ(nearest[q].second, expected.second);
      }
      EXPECT_EQ(nearest[num_queries].index, 7U);
    }
}

TEST_P(HammingKernelTest, TakesTheFirstOfEqualDistances) {
  // Five random bits: 32 different descriptors, so that every distance occurs many times.
  const auto train = random_descriptors(2000, 5, 4);
  const auto queries = random_descriptors(70, 5, 5);
  std::vector<NearestDescriptor> nearest(queries.size());
  hamming::nearest_descriptors(*GetParam(), queries, train, nearest.data());
  for (std::size_t q = 0; q < queries.size(); ++q) {
    const NearestDescriptor expected = nearest_by_definition(queries[q], train);
    ASSERT_EQ(nearest[q].index, expected.index);
    ASSERT_EQ(nearest[q].distance, expected.distance);
    ASSERT_EQ(nearest[q].second, expected.second);
  }
}

TEST_P(HammingKernelTest, HoldsTheLargestDistance) {
  std::vector<Descriptor> train(40), queries(5);
  for (Descriptor& descriptor : train) descriptor.bits = {~0ULL, ~0ULL, ~0ULL, ~0ULL};
  std::vector<NearestDescriptor> nearest(queries.size());
  hamming::nearest_descriptors(*GetParam(), queries, train, nearest.data());
  for (const NearestDescriptor& result : nearest) {
    EXPECT_EQ(result.index, 0U);
    EXPECT_EQ(result.distance, 256);
    EXPECT_EQ(result.second, 256);
  }
}

TEST_P(HammingKernelTest, WorksBeyondSixteenBitPositions) {
  const auto train = random_descriptors(150001, 256, 6);
  const std::vector<Descriptor> queries{train[3], train[65535], train[65536], train[149999], train[150000]};
  std::vector<NearestDescriptor> nearest(queries.size());
  hamming::nearest_descriptors(*GetParam(), queries, train, nearest.data());
  for (std::size_t q = 0; q < queries.size(); ++q) {
    const NearestDescriptor expected = nearest_by_definition(queries[q], train);
    EXPECT_EQ(nearest[q].index, expected.index);
    EXPECT_EQ(nearest[q].distance, 0);
    EXPECT_EQ(nearest[q].second, expected.second);
  }
}

INSTANTIATE_TEST_SUITE_P(Kernels, HammingKernelTest, ::testing::ValuesIn(hamming::available_kernels()),
                         [](const auto& kernel) { return std::string(kernel.param->name); });

}  // namespace
}  // namespace camloc
