// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapmaking/vocabulary.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/features/hamming.h"

namespace camloc {
namespace {

Descriptor random_descriptor(std::mt19937_64& random) { return {{random(), random(), random(), random()}}; }

Descriptor with_flips(const Descriptor& original, int num_bits, std::mt19937_64& random) {
  Descriptor descriptor = original;
  for (int i = 0; i < num_bits; ++i) {
    const std::uint64_t bit = random() % 256;
    descriptor.bits[bit / 64] ^= std::uint64_t{1} << (bit % 64);
  }
  return descriptor;
}

TEST(Vocabulary, FindsPlantedClusters) {
  std::mt19937_64 random(3);
  std::vector<Descriptor> centres, descriptors;
  for (int c = 0; c < 70; ++c) centres.push_back(random_descriptor(random));
  for (int i = 0; i < 70 * 40; ++i) descriptors.push_back(with_flips(centres[static_cast<std::size_t>(i % 70)], 25, random));
  const auto words = train_vocabulary(descriptors, 70);
  std::vector<NearestDescriptor> nearest(centres.size());
  nearest_descriptors(centres, words, nearest.data());
  // k-means++ finds nearly all, and the majority of 40 members with 25 flips each is the centre but for a bit or two.
  EXPECT_GE(std::count_if(nearest.begin(), nearest.end(), [](const NearestDescriptor& n) { return n.distance <= 4; }), 63);
}

TEST(Vocabulary, AWordIsTheMajorityOfManyDescriptors) {
  std::mt19937_64 random(9);
  const Descriptor centre = random_descriptor(random);
  std::vector<Descriptor> descriptors;
  for (int i = 0; i < 1001; ++i) descriptors.push_back(with_flips(centre, 100, random));
  Descriptor majority{};
  for (std::size_t bit = 0; bit < 256; ++bit) {
    const auto has_bit = [bit](const Descriptor& d) { return (d.bits[bit / 64] >> (bit % 64) & 1U) != 0; };
    if (std::count_if(descriptors.begin(), descriptors.end(), has_bit) > 500) majority.bits[bit / 64] |= std::uint64_t{1} << (bit % 64);
  }
  EXPECT_EQ(train_vocabulary(descriptors, 1, 3), std::vector<Descriptor>{majority});
}

TEST(Vocabulary, IterationsReduceTheDistance) {
  std::mt19937_64 random(4);
  std::vector<Descriptor> descriptors;
  for (int i = 0; i < 3000; ++i) descriptors.push_back(random_descriptor(random));
  const auto mean_distance = [&](const std::vector<Descriptor>& words) {
    std::vector<NearestDescriptor> nearest(descriptors.size());
    nearest_descriptors(descriptors, words, nearest.data());
    double sum = 0;
    for (const auto& n : nearest) sum += n.distance;
    return sum / static_cast<double>(descriptors.size());
  };
  EXPECT_LT(mean_distance(train_vocabulary(descriptors, 100, 8)), mean_distance(train_vocabulary(descriptors, 100, 0)) - 1);
}

TEST(Vocabulary, WordsDiffer) {
  std::mt19937_64 random(5);
  const Descriptor a = random_descriptor(random), b = random_descriptor(random);
  const auto words = train_vocabulary(std::vector<Descriptor>{a, a, b, a, b, b, a}, 5);
  EXPECT_EQ(words.size(), 2U);
  EXPECT_NE(std::find(words.begin(), words.end(), a), words.end());
  EXPECT_NE(std::find(words.begin(), words.end(), b), words.end());
  EXPECT_TRUE(train_vocabulary({}, 5).empty());
}

TEST(Vocabulary, IsDeterministic) {
  std::mt19937_64 random(6);
  std::vector<Descriptor> descriptors;
  for (int i = 0; i < 500; ++i) descriptors.push_back(random_descriptor(random));
  EXPECT_EQ(train_vocabulary(descriptors, 64), train_vocabulary(descriptors, 64));
}

TEST(Vocabulary, NumberOfWordsFollowsTheMap) {
  EXPECT_EQ(default_num_words(10), 10);
  EXPECT_EQ(default_num_words(500), 64);
  EXPECT_EQ(default_num_words(24'000), 1000);
  EXPECT_EQ(default_num_words(1'000'000), 2048);
}

TEST(InvertedFile, HoldsNormalizedTfIdf) {
  std::mt19937_64 random(7);
  MapData map;
  for (int i = 0; i < 4; ++i) map.words.push_back(random_descriptor(random));
  for (int i = 0; i < 4; ++i) {
    MapLandmark& landmark = map.landmarks.emplace_back();
    landmark.descriptors.push_back(with_flips(map.words[static_cast<std::size_t>(i == 3 ? 2 : i)], 5, random));
  }
  map.landmarks[0].descriptors.push_back(map.words[1]);
  map.keyframes.resize(3);
  map.keyframes[0].landmarks = {0};        // words 0, 1
  map.keyframes[1].landmarks = {1, 2, 3};  // words 1, 2, 2
  map.keyframes[2].landmarks = {2};        // word 2
  build_inverted_file(&map);
  ASSERT_EQ(map.inverted_file.size(), 4U);

  const double idf_0 = std::log(1 + 3.0 / 1), idf_1 = std::log(1 + 3.0 / 2), idf_2 = idf_1;
  const auto expected = [](double weight, double norm) { return static_cast<int>(std::lround(255 * weight / norm)); };
  const double norm_0 = std::hypot(idf_0, idf_1), norm_1 = std::hypot(idf_1, 2 * idf_2);
  ASSERT_EQ(map.inverted_file[0].size(), 1U);
  EXPECT_EQ(map.inverted_file[0][0].keyframe, 0);
  EXPECT_EQ(map.inverted_file[0][0].weight, expected(idf_0, norm_0));
  ASSERT_EQ(map.inverted_file[1].size(), 2U);
  EXPECT_EQ(map.inverted_file[1][0].weight, expected(idf_1, norm_0));
  EXPECT_EQ(map.inverted_file[1][1].keyframe, 1);
  EXPECT_EQ(map.inverted_file[1][1].weight, expected(idf_1, norm_1));
  ASSERT_EQ(map.inverted_file[2].size(), 2U);
  EXPECT_EQ(map.inverted_file[2][0].weight, expected(2 * idf_2, norm_1));
  EXPECT_EQ(map.inverted_file[2][1].weight, 255);
  EXPECT_TRUE(map.inverted_file[3].empty());
}

}  // namespace
}  // namespace camloc
