// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/rivals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace camloc {
namespace {

constexpr RivalDistance kApart{.position_m = 0.25, .rotation_rad = 0.2};

Hypothesis pose_at(double x_m, double turn_rad, std::uint32_t num_inliers) {
  Hypothesis pose;
  pose.is_found = true;
  pose.T_map_camera = {exp_so3({0, turn_rad, 0}), {x_m, 0, 0}};
  pose.num_inliers = num_inliers;
  return pose;
}

TEST(Rivals, AreApartInPositionOrInRotation) {
  const Rigid3 here = pose_at(0, 0, 1).T_map_camera;
  EXPECT_FALSE(are_rivals(here, pose_at(0.24, 0.19, 1).T_map_camera, kApart));
  EXPECT_TRUE(are_rivals(here, pose_at(0.26, 0, 1).T_map_camera, kApart));
  EXPECT_TRUE(are_rivals(here, pose_at(0, 0.21, 1).T_map_camera, kApart));
}

TEST(Rivals, TheStrongestOneMakesTheMargin) {
  const Hypothesis best = pose_at(0, 0, 100);
  std::vector<Hypothesis> found = {best};
  EXPECT_EQ(margin_of(found, best, kApart), 1);
  found.push_back(pose_at(0.1, 0, 99));  // the same place
  EXPECT_EQ(margin_of(found, best, kApart), 1);
  found.push_back(pose_at(3, 0, 30));
  found.push_back(pose_at(0, 1, 60));
  EXPECT_DOUBLE_EQ(margin_of(found, best, kApart), 0.4);
  found.push_back(pose_at(5, 0, 90));
  found.back().is_found = false;
  EXPECT_DOUBLE_EQ(margin_of(found, best, kApart), 0.4) << "what was not found is no rival";
}

/// Explains the features [begin, end), those below `distinct_end` by landmarks that are nowhere else.
Hypothesis explaining(Hypothesis pose, std::size_t begin, std::size_t end, std::size_t distinct_end) {
  for (std::size_t i = begin; i < end; ++i) {
    pose.explained.add(i);
    if (i < distinct_end) pose.distinct.add(i);
  }
  return pose;
}

TEST(Rivals, OnlyWhatOnePoseExplainsAloneMakesItsLead) {
  const Hypothesis best = explaining(pose_at(0, 0, 100), 0, 100, 40);
  std::vector<Hypothesis> found = {best};
  EXPECT_TRUE(std::isinf(lead_of(found, best, kApart))) << "no rival";
  found.push_back(explaining(pose_at(9, 0, 60), 40, 100, 0));
  EXPECT_TRUE(std::isinf(lead_of(found, best, kApart))) << "nobody says that they look alike";
  found.back().is_look_alike = true;
  EXPECT_DOUBLE_EQ(lead_of(found, best, kApart), 40 / std::sqrt(41.0)) << "what both explain says nothing";
  found.push_back(explaining(pose_at(18, 0, 100), 30, 130, 0));
  found.back().is_look_alike = true;
  EXPECT_DOUBLE_EQ(lead_of(found, best, kApart), 30 / std::sqrt(31.0)) << "the nearest counts, and repeated features do not";
  found.push_back(explaining(pose_at(27, 0, 100), 100, 140, 140));
  found.back().is_look_alike = true;
  EXPECT_DOUBLE_EQ(lead_of(found, best, kApart), 0) << "as much speaks for it";
}

TEST(Rivals, ALookAlikeOfTheMapHasNoSayInTheMargin) {
  const Hypothesis best = pose_at(0, 0, 100);
  Hypothesis twin = pose_at(9, 0, 95);
  twin.is_look_alike = true;
  EXPECT_EQ(margin_of(std::vector{best, twin}, best, kApart), 1);
}

TEST(Rivals, FeaturesBeyondTheSetAreLeftOut) {
  FeatureSet set;
  set.add(FeatureSet::kCapacity);
  EXPECT_EQ(set.count_without(FeatureSet{}), 0U);
  set.add(FeatureSet::kCapacity - 1);
  EXPECT_EQ(set.count_without(FeatureSet{}), 1U);
  set.clear();
  EXPECT_EQ(set.count_without(FeatureSet{}), 0U);
}

TEST(Rivals, NothingHasNoMargin) {
  const std::vector<Hypothesis> none;
  EXPECT_EQ(margin_of(none, Hypothesis{}, kApart), 0);
  EXPECT_EQ(margin_of(none, pose_at(0, 0, 0), kApart), 0);
}

}  // namespace
}  // namespace camloc
