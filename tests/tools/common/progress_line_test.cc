// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/common/progress_line.h"

#include <gtest/gtest.h>

namespace camloc::tools {
namespace {

TEST(ProgressLineTest, ShowsShareAndTimeLeft) {
  EXPECT_EQ(format_progress(0, 4, "frame", "", 0), "[........................] frame 0/4");
  EXPECT_EQ(format_progress(1, 4, "frame", "1 localized", 2), "[######..................] frame 1/4  1 localized  6 s left");
  EXPECT_EQ(format_progress(9, 4, "frame", "", 2), "[########################] frame 9/4  0 s left");
  EXPECT_EQ(format_progress(9, 0, "frame", "", 2), "frame 9");
}

TEST(ProgressLineTest, IsSilentWhereThereIsNoTerminal) {
  ::testing::internal::CaptureStderr();
  { ProgressLine(3).show(3); }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace camloc::tools
