// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/training/held_out.h"

#include <gtest/gtest.h>

namespace camloc::training {
namespace {

std::vector<TrainingView> views(std::initializer_list<std::pair<std::uint32_t, std::uint64_t>> recording_and_frame) {
  std::vector<TrainingView> all;
  for (const auto& [recording, frame] : recording_and_frame) {
    all.emplace_back();
    all.back().recording = recording;
    all.back().frame = frame;
  }
  return all;
}

TEST(HeldOut, TheLastTenthOfEachRecording) {
  std::vector<TrainingView> all(25);
  for (std::size_t i = 0; i < all.size(); ++i) all[i].recording = i < 20 ? 0 : 1;
  const auto split = split_views(all, "");
  ASSERT_TRUE(split);
  EXPECT_EQ(split->held_out, (std::vector<std::size_t>{18, 19, 24}));
  EXPECT_EQ(split->shown.size(), 22U);
}

TEST(HeldOut, StretchesAreFrameNumbersOfEveryRecording) {
  const auto split = split_views(views({{0, 2}, {0, 5}, {0, 9}, {1, 5}}), "4:6,9:10");
  ASSERT_TRUE(split);
  EXPECT_EQ(split->held_out, (std::vector<std::size_t>{1, 2, 3}));
  EXPECT_EQ(split->shown, (std::vector<std::size_t>{0}));
}

TEST(HeldOut, BothSidesNeedAFrame) {
  EXPECT_FALSE(split_views(views({{0, 2}, {0, 5}}), "0:9"));
  EXPECT_FALSE(split_views(views({{0, 2}, {0, 5}}), "3:4"));
  EXPECT_FALSE(split_views(views({{0, 2}, {0, 5}}), "three"));
}

}  // namespace
}  // namespace camloc::training
