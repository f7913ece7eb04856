// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/frame_source.h"

#include <gtest/gtest.h>

namespace camloc {
namespace {

TEST(FrameSource, UnknownSchemeListsTheKnown) {
  const auto source = open_frame_source("nosuch://0");
  ASSERT_FALSE(source.is_ok());
  EXPECT_EQ(source.status().code(), ErrorCode::kUnsupported);
  for (const FrameSourceScheme& scheme : frame_source_schemes()) {
    EXPECT_NE(source.status().message().find(scheme.scheme + "://"), std::string::npos) << source.status().message();
  }
}

TEST(FrameSource, EverySchemeHasHelpThatStartsWithIt) {
  ASSERT_GE(frame_source_schemes().size(), 2U);
  for (const FrameSourceScheme& scheme : frame_source_schemes()) EXPECT_TRUE(scheme.help.starts_with(scheme.scheme + "://"));
}

}  // namespace
}  // namespace camloc
