// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Against a plain implementation in double, and the promises on order, ties and bounds.
#include "core/map/retrieval.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/map/map_writer.h"
#include "tests/map/synthetic_map.h"

namespace camloc {
namespace {

using testing::make_synthetic_map;

/// A map opened from a file that is gone again.
MapView open_map(const MapData& map) {
  const testing::TemporaryFolder folder;
  const Status written = write_map(map, folder.file("map.cmap"));
  EXPECT_TRUE(written.is_ok()) << written.message();
  return MapView::open(folder.file("map.cmap")).value();
}

MapData large_map(std::uint32_t seed = 1) {
  return make_synthetic_map({.num_landmarks = 2000, .num_keyframes = 20, .landmarks_per_keyframe = 200, .num_words = 128, .seed = seed});
}

/// Noisy descriptors of what a keyframe sees.
std::vector<Descriptor> view_of(const MapData& map, std::size_t keyframe, int noise_bits) {
  testing::Random random(11);
  std::vector<Descriptor> descriptors;
  for (const auto l : map.keyframes[keyframe].landmarks) {
    descriptors.push_back(random.noisy(map.landmarks[l].descriptors[0], noise_bits));
  }
  return descriptors;
}

std::vector<double> plain_scores(const MapData& map, const std::vector<Descriptor>& descriptors) {
  std::vector<double> counts(map.words.size()), scores(map.keyframes.size());
  for (const auto& d : descriptors) ++counts[testing::nearest_word(map.words, d)];
  double squared = 0;
  for (std::size_t w = 0; w < counts.size(); ++w) {
    const auto& entries = map.inverted_file[w];
    if (entries.empty()) continue;
    const double keyframes_per_entry = static_cast<double>(map.keyframes.size()) / static_cast<double>(entries.size());
    const double weight = counts[w] * std::log(1 + keyframes_per_entry);
    squared += weight * weight;
    for (const auto& entry : entries) scores[entry.keyframe] += weight * entry.weight / 255;
  }
  for (double& score : scores) score /= std::sqrt(squared);
  return scores;
}

TEST(Retriever, FindsTheKeyframeThatSeesTheSame) {
  const MapData map = large_map();
  const MapView view = open_map(map);
  Retriever retriever(view, 1000);
  for (std::uint32_t k = 0; k < map.keyframes.size(); ++k) {
    const auto found = retriever.retrieve(view_of(map, k, 30), 3);
    ASSERT_EQ(found.size(), 3U);
    EXPECT_EQ(found[0].keyframe, k);
    EXPECT_GT(found[0].score, 0.9F);
    EXPECT_LE(found[0].score, 1.1F);
  }
}

TEST(Retriever, AgreesWithThePlainSum) {
  const MapData map = large_map();
  const MapView view = open_map(map);
  Retriever retriever(view, 1000);
  testing::Random random(5);
  std::vector<Descriptor> image;
  for (int i = 0; i < 300; ++i) image.push_back(random.descriptor());
  const std::vector<double> expected = plain_scores(map, image);
  const auto found = retriever.retrieve(image, 20);
  ASSERT_EQ(found.size(), 20U);
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_NEAR(found[i].score, expected[found[i].keyframe], 1e-5);
    EXPECT_GE(found[i == 0 ? 0 : i - 1].score, found[i].score);
  }
}

TEST(Retriever, SelectionIsTheHeadOfTheFullOrder) {
  const MapData map = large_map();
  const MapView view = open_map(map);
  Retriever retriever(view, 1000);
  const auto image = view_of(map, 4, 60);
  const auto span = retriever.retrieve(image, 20);
  const std::vector<RankedKeyframe> all(span.begin(), span.end());
  for (int count = 0; count <= 25; ++count) {
    const auto found = retriever.retrieve(image, count);
    ASSERT_EQ(found.size(), static_cast<std::size_t>(std::min(count, 20)));
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].keyframe, all[i].keyframe);
      EXPECT_EQ(found[i].score, all[i].score);
    }
  }
  EXPECT_TRUE(retriever.retrieve(image, -1).empty());
}

TEST(Retriever, SameBitsWhateverTheOrderOfTheFeatures) {
  const MapData map = large_map();
  const MapView view = open_map(map);
  Retriever a(view, 1000), b(view, 1000);
  auto image = view_of(map, 9, 60);
  const auto forward = a.retrieve(image, 20);
  std::reverse(image.begin(), image.end());
  const auto backward = b.retrieve(image, 20);
  ASSERT_EQ(forward.size(), backward.size());
  for (std::size_t i = 0; i < forward.size(); ++i) {
    EXPECT_EQ(forward[i].keyframe, backward[i].keyframe);
    EXPECT_EQ(forward[i].score, backward[i].score);
  }
}

TEST(Retriever, TiesGoToTheLowerIndex) {
  MapData map = make_synthetic_map({.num_keyframes = 6, .num_words = 2});
  map.inverted_file[0] = {{1, 9}, {2, 9}, {3, 10}, {4, 9}, {5, 9}};
  map.inverted_file[1] = {{0, 200}};
  const MapView view = open_map(map);
  Retriever retriever(view, 10);
  const auto found = retriever.retrieve(std::vector{map.words[0]}, 4);
  ASSERT_EQ(found.size(), 4U);
  EXPECT_EQ(found[0].keyframe, 3U);
  EXPECT_EQ(found[1].keyframe, 1U);
  EXPECT_EQ(found[2].keyframe, 2U);
  EXPECT_EQ(found[3].keyframe, 4U);
}

TEST(Retriever, KeyframesWithoutACommonWordAreNotFound) {
  MapData map = make_synthetic_map({.num_keyframes = 4, .num_words = 2});
  map.inverted_file[0] = {{2, 50}};
  map.inverted_file[1] = {{0, 200}, {3, 10}};
  const MapView view = open_map(map);
  Retriever retriever(view, 10);
  const auto found = retriever.retrieve(std::vector{map.words[0]}, 4);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].keyframe, 2U);
  EXPECT_TRUE(retriever.retrieve({}, 4).empty());
}

TEST(Retriever, IgnoresFeaturesBeyondItsBuffer) {
  MapData map = make_synthetic_map({.num_keyframes = 2, .num_words = 2});
  map.inverted_file[0] = {{0, 50}};
  map.inverted_file[1] = {{1, 50}};
  const MapView view = open_map(map);
  Retriever retriever(view, 2);
  const auto found = retriever.retrieve(std::vector{map.words[0], map.words[0], map.words[1], map.words[1]}, 4);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].keyframe, 0U);
}

TEST(Retriever, MapWithoutWordsFindsNothing) {
  const MapData map = make_synthetic_map({.num_words = 0});
  const MapView view = open_map(map);
  Retriever retriever(view, 10);
  EXPECT_TRUE(retriever.retrieve(map.landmarks[0].descriptors, 4).empty());
}

}  // namespace
}  // namespace camloc
