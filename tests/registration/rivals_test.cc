// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/rivals.h"

#include <gtest/gtest.h>

#include <vector>

#include "core/registration/pose_evidence.h"

namespace camloc {
namespace {

constexpr RivalDistance kApart{.position_m = 0.25, .rotation_rad = 0.2};

PoseEvidence pose_at(double x_m, double turn_rad, std::uint32_t num_inliers) {
  PoseEvidence pose;
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
  const PoseEvidence best = pose_at(0, 0, 100);
  std::vector<PoseEvidence> found = {best};
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

TEST(Rivals, NothingHasNoMargin) {
  const std::vector<PoseEvidence> none;
  EXPECT_EQ(margin_of(none, PoseEvidence{}, kApart), 0);
  EXPECT_EQ(margin_of(none, pose_at(0, 0, 0), kApart), 0);
}

}  // namespace
}  // namespace camloc
