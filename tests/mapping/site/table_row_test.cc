// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/mapping/site/table_row.h"

#include <gtest/gtest.h>

namespace camloc::mapping {
namespace {

TEST(TableRow, SplitsWhatSurveyorsWrite) {
  std::string buffer;
  const struct {
    const char* line;
    Row row;
  } rows[] = {
      {"A 1 2 3", {"A", "1", "2", "3"}},
      {"A, 1, 2, 3  # comment", {"A", "1", "2", "3"}},
      {"Door 3\t1.5\t2\t3", {"Door 3", "1.5", "2", "3"}},
      {"Door 3;1,5;-2,25;3;;", {"Door 3", "1.5", "-2.25", "3"}},
      {"Door, left;1,5;-2,25;3", {"Door, left", "1.5", "-2.25", "3"}},
      {"Door 1,5;1.5;-2.25;3", {"Door 1,5", "1.5", "-2.25", "3"}},
      {"\"a; b\";1;2;3", {"a; b", "1", "2", "3"}},
      {"\"a, b\", 1, 2, 3", {"a, b", "1", "2", "3"}},
      {"O'Neil;1;2;3'", {"O'Neil", "1", "2", "3'"}},
      {"pipe 2\"\t1\t2\t3", {"pipe 2\"", "1", "2", "3"}},
      {"nail#2 1 2 3", {"nail#2", "1", "2", "3"}},
      {"", {}},
  };
  for (const auto& [line, row] : rows) EXPECT_EQ(split_row(line, 4, &buffer), row) << line;
}

TEST(TableRow, TellsANameThatBlanksSplit) {
  std::string buffer;
  const auto is_split = [&](const char* line) { return has_split_name(line, split_row(line, 4, &buffer)); };
  EXPECT_TRUE(is_split("Door 3 0.5 0.4 0.6"));
  for (const char* line :
       {"Door 3 5 4 0.6", "Door 3.0 0.5 0.4 0.6", "Door 3\t0.5\t0.4\t0.6", "Door 3;0.5;0.4;0.6", "\"Door 3\" 0.5 0.4 0.6"}) {
    EXPECT_FALSE(is_split(line)) << line;
  }
}

}  // namespace
}  // namespace camloc::mapping
