// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/training/training_set.h"

#include <gtest/gtest.h>

#include <numeric>

#include "tests/training/views.h"

namespace camloc::training {
namespace {

constexpr AugmentationLimits kNone{0, 0, 0, 0, 0, 0};

double mean_difference(std::span<const float> a, std::span<const float> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::abs(a[i] - b[i]);
  return sum / static_cast<double>(a.size());
}

// What is trained on must be what is used: the device fills the input by NetworkInput.
TEST(TrainingSet, AnUnchangedViewIsWhatTheDeviceSees) {
  const WallView wall(pose_on_path(3, 40));
  TrainingSet set(test_camera(), small_layout(), false);
  set.add(wall.frame(), pose_on_path(3, 40), 0);
  std::vector<float> drawn(set.input_size()), seen(set.input_size());
  std::mt19937_64 random(1);
  const Rigid3 pose = set.draw(0, kNone, &random, drawn);
  NetworkInput(test_camera(), small_layout()).fill(wall.frame(), seen);
  EXPECT_LT(mean_difference(drawn, seen), 0.02);  // of a standard deviation
  EXPECT_LT((pose.translation - pose_on_path(3, 40).translation).norm(), 1e-12);
  EXPECT_LT(rotation_distance_rad(pose.rotation, pose_on_path(3, 40).rotation), 1e-9);
}

// The image that belongs to the pose that is returned: as a camera there would have seen it.
TEST(TrainingSet, ATurnedViewBelongsToItsPose) {
  TrainingSet set = walk_before_wall(1);
  AugmentationLimits turns = kNone;
  turns.turn_rad = 0.05;
  turns.roll_rad = 0.1;
  std::vector<float> drawn(set.input_size()), seen(set.input_size()), unturned(set.input_size());
  std::mt19937_64 random(7);
  for (int round = 0; round < 5; ++round) {
    const Rigid3 pose = set.draw(0, turns, &random, drawn);
    EXPECT_GT(rotation_distance_rad(pose.rotation, pose_on_path(0, 1).rotation), 1e-3);
    NetworkInput(test_camera(), small_layout()).fill(WallView(pose).frame(), seen);
    NetworkInput(test_camera(), small_layout()).fill(WallView(pose_on_path(0, 1)).frame(), unturned);
    EXPECT_LT(mean_difference(drawn, seen), 0.35 * mean_difference(drawn, unturned)) << round;
  }
}

TEST(TrainingSet, DepthIsALayerOfItsOwn) {
  TrainingSet set = walk_before_wall(1, true);
  std::vector<float> drawn(set.input_size());
  std::mt19937_64 random(1);
  static_cast<void>(set.draw(0, kNone, &random, drawn));
  const std::size_t size = drawn.size() / 2, middle = 48 * 128 + 64;
  EXPECT_NEAR(drawn[size + middle], (2 - pose_on_path(0, 1).translation.z()) / 5, 0.03);
}

TEST(TrainingSet, TheSameGeneratorDrawsTheSame) {
  TrainingSet set = walk_before_wall(1);
  std::vector<float> first(set.input_size()), second(set.input_size());
  std::mt19937_64 a(5), b(5);
  const Rigid3 one = set.draw(0, {}, &a, first), other = set.draw(0, {}, &b, second);
  EXPECT_EQ(first, second);
  EXPECT_EQ(one.rotation.coeffs(), other.rotation.coeffs());
  static_cast<void>(set.draw(0, {}, &a, second));
  EXPECT_NE(first, second);
}

TEST(TrainingSet, NothingIsLearnedFromAFewFramesOrAStandstill) {
  EXPECT_NE(check_training_views(walk_before_wall(19).views()).message().find("19 frames"), std::string::npos);
  EXPECT_TRUE(check_training_views(walk_before_wall(20).views()));
  TrainingSet still(test_camera(), small_layout(), false);
  for (int i = 0; i < 30; ++i) still.add(WallView(pose_on_path(0, 1)).frame(), pose_on_path(0, 1), 0);
  EXPECT_NE(check_training_views(still.views()).message().find("stood still"), std::string::npos);
}

}  // namespace
}  // namespace camloc::training
