// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/tfidf.h"

#include <gtest/gtest.h>

namespace camloc {
namespace {

Descriptor filled(std::uint8_t byte) {
  Descriptor d{};
  d.bits.fill(0x0101010101010101U * byte);
  return d;
}

TEST(Tfidf, RareWordsWeighMore) {
  EXPECT_NEAR(inverse_document_frequency(100, 1), std::log(101.0), 1e-12);
  EXPECT_NEAR(inverse_document_frequency(100, 100), std::log(2.0), 1e-12) << "a word seen everywhere still counts";
  EXPECT_GT(inverse_document_frequency(100, 5), inverse_document_frequency(100, 50));
  EXPECT_EQ(inverse_document_frequency(100, 0), inverse_document_frequency(100, 1));
}

TEST(Tfidf, CountsTheNearestWords) {
  const std::vector<Descriptor> words = {filled(0x00), filled(0xFF), filled(0x0F)};
  const std::vector<Descriptor> descriptors = {filled(0x01), filled(0xFE), filled(0x0E), filled(0xFF), filled(0x00)};
  std::vector<NearestDescriptor> nearest(descriptors.size());
  std::vector<std::uint32_t> counts = {7, 7, 7};
  count_words(descriptors, words, nearest, counts);
  EXPECT_EQ(counts, (std::vector<std::uint32_t>{2, 2, 1}));
}

TEST(Tfidf, RanksTheBestFirstAndTiesByIndex) {
  const std::vector<float> scores = {0.2F, 0, 0.9F, 0.2F, -1, 0.5F};
  std::vector<RankedKeyframe> ranked;
  const auto all = rank_keyframes(scores, 100, &ranked);
  ASSERT_EQ(all.size(), 4U);
  EXPECT_EQ(all[0].keyframe, 2U);
  EXPECT_EQ(all[1].keyframe, 5U);
  EXPECT_EQ(all[2].keyframe, 0U);
  EXPECT_EQ(all[3].keyframe, 3U);
  EXPECT_EQ(rank_keyframes(scores, 2, &ranked).size(), 2U);
  EXPECT_TRUE(rank_keyframes(scores, 0, &ranked).empty());
  EXPECT_TRUE(rank_keyframes(scores, -3, &ranked).empty());
  EXPECT_TRUE(rank_keyframes({}, 5, &ranked).empty());
}

}  // namespace
}  // namespace camloc
