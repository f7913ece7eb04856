// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/matcher.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "core/features/hamming.h"

namespace camloc {
namespace {

Descriptor random_descriptor(std::mt19937_64& random) {
  Descriptor descriptor;
  for (auto& bits : descriptor.bits) bits = random();
  return descriptor;
}

/// The descriptor with its first `count` bits flipped.
Descriptor flipped(const Descriptor& original, int count) {
  Descriptor descriptor = original;
  for (int i = 0; i < count; ++i) descriptor.bits[static_cast<std::size_t>(i / 64)] ^= 1ULL << i % 64;
  return descriptor;
}

Features features_at(const std::vector<Keypoint>& keypoints, std::mt19937_64& random) {
  Features features;
  features.keypoints = keypoints;
  for (std::size_t i = 0; i < keypoints.size(); ++i) features.descriptors.push_back(random_descriptor(random));
  return features;
}

TEST(FeatureGrid, HoldsEveryFeatureOnceInItsBucket) {
  std::mt19937_64 random(1);
  std::vector<Keypoint> keypoints;
  for (int i = 0; i < 500; ++i) keypoints.push_back({static_cast<float>(random() % 640), static_cast<float>(random() % 480), 0, 0, 0});
  keypoints.push_back({-5, 1000, 0, 0, 0});  // outside: nearest bucket
  FeatureGrid grid(640, 480, 600);
  for (int repeat = 0; repeat < 2; ++repeat) {
    grid.assign(keypoints);
    std::set<std::int32_t> seen;
    for (int row = 0; row < grid.rows(); ++row)
      for (int column = 0; column < grid.columns(); ++column)
        for (const std::int32_t feature : grid.bucket(column, row)) {
          EXPECT_TRUE(seen.insert(feature).second);
          if (feature == 500) continue;
          const Keypoint& keypoint = keypoints[static_cast<std::size_t>(feature)];
          EXPECT_EQ(static_cast<int>(keypoint.u) / grid.cell_px(), column);
          EXPECT_EQ(static_cast<int>(keypoint.v) / grid.cell_px(), row);
        }
    EXPECT_EQ(seen.size(), keypoints.size());
  }
}

TEST(FeatureGrid, IgnoresFeaturesBeyondItsSize) {
  FeatureGrid grid(100, 100, 3, 100);
  grid.assign(std::vector<Keypoint>(10));
  EXPECT_EQ(grid.bucket(0, 0).size(), 3U);
}

class GuidedMatcherTest : public ::testing::Test {
 protected:
  std::span<const Match> match(const Features& features, const std::vector<ProjectedLandmark>& landmarks,
                               const std::vector<Descriptor>& descriptors) {
    grid_.assign(features.keypoints);
    return matcher_.match(features, grid_, landmarks, descriptors);
  }
  std::mt19937_64 random_{2};
  FeatureGrid grid_{640, 480, 100};
  GuidedMatcher matcher_{GuidedMatcherOptions{}, 100};
};

TEST_F(GuidedMatcherTest, FindsTheFeatureInTheWindowOnly) {
  const Features features = features_at({{100, 100, 0, 0, 0}, {107, 100, 0, 0, 0}, {300, 200, 0, 0, 3}}, random_);
  const std::vector<Descriptor> descriptors{flipped(features.descriptors[0], 10)};
  ProjectedLandmark landmark{42, 104, 103, 8, 0, 7, 0, 1};
  ASSERT_EQ(match(features, {landmark}, descriptors).size(), 1U);
  const Match found = match(features, {landmark}, descriptors)[0];
  EXPECT_EQ(found.feature, 0);
  EXPECT_EQ(found.landmark, 42);
  EXPECT_EQ(found.distance, 10);
  EXPECT_EQ(found.second, hamming_distance(descriptors[0], features.descriptors[1]));

  landmark.radius_px = 4.9F;  // the feature is 5 px away
  EXPECT_EQ(match(features, {landmark}, descriptors).size(), 0U);
  landmark.radius_px = 8;
  landmark.min_level = 1;
  EXPECT_EQ(match(features, {landmark}, descriptors).size(), 0U);
}

TEST_F(GuidedMatcherTest, RatioCountsRivalsOnNearbyLevelsOnly) {
  Features features = features_at({{100, 100, 0, 0, 2}, {101, 100, 0, 0, 3}}, random_);
  features.descriptors[1] = flipped(features.descriptors[0], 2);
  const std::vector<Descriptor> descriptors{flipped(features.descriptors[0], 40)};
  const ProjectedLandmark landmark{1, 100, 100, 8, 0, 7, 0, 1};
  EXPECT_EQ(match(features, {landmark}, descriptors).size(), 0U);
  features.keypoints[1].level = 4;
  ASSERT_EQ(match(features, {landmark}, descriptors).size(), 1U);
  EXPECT_EQ(match(features, {landmark}, descriptors)[0].second, 257);
}

TEST_F(GuidedMatcherTest, ContestedFeatureGoesToTheClosestLandmark) {
  const Features features = features_at({{100, 100, 0, 0, 0}}, random_);
  const std::vector<Descriptor> descriptors{flipped(features.descriptors[0], 20), random_descriptor(random_),
                                            flipped(features.descriptors[0], 5)};
  // The second landmark has two appearances; the better one counts.
  const std::vector<ProjectedLandmark> landmarks{{7, 100, 100, 8, 0, 7, 0, 1}, {8, 101, 100, 8, 0, 7, 1, 2}};
  const auto matches = match(features, landmarks, descriptors);
  ASSERT_EQ(matches.size(), 1U);
  EXPECT_EQ(matches[0].landmark, 8);
  EXPECT_EQ(matches[0].distance, 5);
}

TEST_F(GuidedMatcherTest, SurvivesNonsense) {
  const Features features = features_at({{100, 100, 0, 0, 0}}, random_);
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  std::vector<ProjectedLandmark> landmarks;
  for (const float value : {nan, inf, -inf, 1e30F, -1e30F}) {
    landmarks.push_back({1, value, 100, 8, 0, 7, 0, 1});
    landmarks.push_back({1, 100, value, 8, 0, 7, 0, 1});
    landmarks.push_back({1, 300, 300, value, 0, 7, 0, 0});
  }
  landmarks.push_back({1, 100, 100, 8, 0, 7, 1000, 5});         // beyond the descriptors
  landmarks.push_back({1, 300, 100, 8, 0, 7, 0, 0xffffffffU});  // range longer than the descriptors
  EXPECT_EQ(match(features, landmarks, features.descriptors).size(), 0U);
}

class CandidateMatcherTest : public ::testing::Test {
 protected:
  CandidateMatcherTest() {
    std::vector<Keypoint> keypoints(300);
    for (std::size_t i = 0; i < keypoints.size(); ++i) keypoints[i].angle_rad = static_cast<float>(i % 60) * 0.1F;
    features_ = features_at(keypoints, random_);
  }
  std::mt19937_64 random_{3};
  Features features_;
  CandidateSet candidates_{1000};
  CandidateMatcherOptions options_{64, 0.9, true, 0};
};

TEST_F(CandidateMatcherTest, EqualsTheDefinition) {
  // Landmarks of one to three appearances, some noisy beyond use, with near copies of each other as rivals.
  for (std::int32_t landmark = 0; landmark < 300; ++landmark)
    for (int appearance = 0; appearance <= landmark % 3; ++appearance) {
      Descriptor descriptor = features_.descriptors[static_cast<std::size_t>(landmark / 2 * 2)];
      for (std::uint64_t i = 0, flips = random_() % 90; i < flips; ++i) descriptor.bits[random_() % 4] ^= 1ULL << random_() % 64;
      ASSERT_TRUE(candidates_.add(descriptor, landmark * 7 - 500, 0));
    }
  std::vector<Match> expected;
  const auto distance_to = [&](std::size_t f, std::size_t c) {
    return hamming_distance(features_.descriptors[f], candidates_.descriptors[c]);
  };
  for (std::size_t f = 0; f < features_.size(); ++f) {
    std::size_t best = 0;
    for (std::size_t c = 0; c < candidates_.size; ++c)
      if (distance_to(f, c) < distance_to(f, best)) best = c;
    const std::int32_t landmark = candidates_.landmarks[best];
    const int distance = distance_to(f, best);
    int rival = 257, closest = 257;
    std::size_t closest_feature = 0;
    for (std::size_t c = 0; c < candidates_.size; ++c)
      if (candidates_.landmarks[c] != landmark) rival = std::min(rival, distance_to(f, c));
    for (std::size_t g = 0; g < features_.size(); ++g)
      for (std::size_t c = 0; c < candidates_.size; ++c)
        if (candidates_.landmarks[c] == landmark && distance_to(g, c) < closest) closest = distance_to(g, c), closest_feature = g;
    if (distance <= 64 && distance <= 0.9 * rival && closest_feature == f)
      expected.push_back({static_cast<std::int32_t>(f), landmark, static_cast<std::uint16_t>(distance), static_cast<std::uint16_t>(rival)});
  }
  ASSERT_GT(expected.size(), 20U);
  CandidateMatcher matcher(options_, 300, 1000);
  for (int repeat = 0; repeat < 2; ++repeat) {
    const auto matches = matcher.match(features_, candidates_);
    ASSERT_EQ(matches.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_EQ(matches[i].feature, expected[i].feature);
      EXPECT_EQ(matches[i].landmark, expected[i].landmark);
      EXPECT_EQ(matches[i].distance, expected[i].distance);
      EXPECT_EQ(matches[i].second, expected[i].second);
    }
  }
}

TEST_F(CandidateMatcherTest, AppearancesOfOneLandmarkAreNoRivals) {
  candidates_.add(flipped(features_.descriptors[0], 10), 5, 0);
  candidates_.add(flipped(features_.descriptors[0], 11), 5, 0);
  CandidateMatcher matcher(options_, 300, 1000);
  ASSERT_EQ(matcher.match(features_, candidates_).size(), 1U);
  EXPECT_EQ(matcher.match(features_, candidates_)[0].second, 257);
  candidates_.add(flipped(features_.descriptors[0], 11), 6, 0);
  EXPECT_EQ(matcher.match(features_, candidates_).size(), 0U);
}

TEST_F(CandidateMatcherTest, MutualKeepsTheLandmarksBestFeature) {
  features_.descriptors[1] = flipped(features_.descriptors[0], 6);
  candidates_.add(flipped(features_.descriptors[0], 4), 5, 0);  // 4 bits from feature 0, 2 from feature 1
  CandidateMatcher mutual(options_, 300, 1000);
  ASSERT_EQ(mutual.match(features_, candidates_).size(), 1U);
  EXPECT_EQ(mutual.match(features_, candidates_)[0].feature, 1);
  options_.is_mutual = false;
  CandidateMatcher one_way(options_, 300, 1000);
  EXPECT_EQ(one_way.match(features_, candidates_).size(), 2U);
}

TEST_F(CandidateMatcherTest, DropsMatchesAgainstTheDominantRotation) {
  // Turned by 6.2 rad, across the wrap of the angle; every tenth by something else.
  for (std::size_t i = 0; i < 100; ++i) {
    const double turn = i % 10 == 0 ? 2.0 + 0.01 * static_cast<double>(i) : 6.2 + (i % 3 == 0 ? 0.15 : 0.0);
    candidates_.add(features_.descriptors[i], static_cast<std::int32_t>(i),
                    static_cast<float>(std::remainder(features_.keypoints[i].angle_rad - turn, 6.283185307)));
  }
  options_.max_rotation_deviation_rad = 0.4;
  CandidateMatcher matcher(options_, 300, 1000);
  const auto matches = matcher.match(features_, candidates_);
  EXPECT_EQ(matches.size(), 90U);
  for (const Match& match : matches) EXPECT_NE(match.feature % 10, 0);
}

TEST_F(CandidateMatcherTest, EmptyInputsGiveNoMatches) {
  CandidateMatcher matcher(CandidateMatcherOptions{}, 300, 1000);
  EXPECT_EQ(matcher.match(features_, candidates_).size(), 0U);
  candidates_.add(features_.descriptors[0], 1, 0);
  EXPECT_EQ(matcher.match(Features{}, candidates_).size(), 0U);
}

TEST(CandidateSet, RefusesWhatDoesNotFit) {
  CandidateSet candidates(2);
  EXPECT_TRUE(candidates.add({}, 1, 0));
  EXPECT_TRUE(candidates.add({}, 2, 0));
  EXPECT_FALSE(candidates.add({}, 3, 0));
  EXPECT_EQ(candidates.size, 2U);
}

}  // namespace
}  // namespace camloc
