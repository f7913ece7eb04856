// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/base/stage_timer.h"

#include <gtest/gtest.h>

namespace camloc {
namespace {

std::int64_t* fake_clock() {
  static std::int64_t now_ns = 0;
  return &now_ns;
}
std::int64_t fake_now() { return *fake_clock(); }

TEST(StageTimer, AddsUpTheTimeOfEachStage) {
  StageTimer timer(fake_now);
  for (int frame = 0; frame < 2; ++frame) {  // a second frame starts from zero
    timer.start();
    *fake_clock() += 5;
    timer.finish(Stage::kExtract);
    *fake_clock() += 70;
    timer.finish(Stage::kMatch);
    *fake_clock() += 100;
    timer.finish(Stage::kEstimate);
    *fake_clock() += 9;
    timer.finish(Stage::kMatch);
    *fake_clock() += 2000;
    const auto stage_ns = timer.stop();
    EXPECT_EQ(stage_ns[static_cast<std::size_t>(Stage::kExtract)], 5);
    EXPECT_EQ(stage_ns[static_cast<std::size_t>(Stage::kCandidates)], 0);
    EXPECT_EQ(stage_ns[static_cast<std::size_t>(Stage::kMatch)], 79);
    EXPECT_EQ(stage_ns[static_cast<std::size_t>(Stage::kEstimate)], 100);
    EXPECT_EQ(stage_ns[static_cast<std::size_t>(Stage::kVerify)], 0);
    EXPECT_EQ(stage_ns[static_cast<std::size_t>(Stage::kTotal)], 2184);
  }
}

TEST(StageTimer, WithoutAClockAllIsZero) {
  StageTimer timer(nullptr);
  timer.start();
  timer.finish(Stage::kMatch);
  for (const std::int64_t ns : timer.stop()) EXPECT_EQ(ns, 0);
}

}  // namespace
}  // namespace camloc
