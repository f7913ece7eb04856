// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/common/text_format.h"

#include <gtest/gtest.h>

namespace camloc::tools {
namespace {

TEST(TextFormat, TakesAsMuchRoomAsItNeeds) {
  const std::string path(3000, 'x');
  EXPECT_EQ(text_of("%s: %.1f cm", path.c_str(), 2.25), path + ": 2.2 cm");
  EXPECT_EQ(text_of("%s", ""), "");
}

TEST(TextFormat, AppendsWithoutAZeroInside) {
  std::string text = "a";
  append_text(&text, "%d", 12);
  append_text(&text, "%s\n", "b");
  EXPECT_EQ(text, "a12b\n");
}

TEST(TextFormat, ControlCharactersAreMarked) { EXPECT_EQ(printable("a\n\x1b[2J\x7f\xc3\xa4"), "a??[2J?\xc3\xa4"); }

TEST(TextFormat, DegreesOfRadians) { EXPECT_DOUBLE_EQ(degrees(std::numbers::pi), 180.0); }

}  // namespace
}  // namespace camloc::tools
