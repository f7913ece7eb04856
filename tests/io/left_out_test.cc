// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/left_out.h"

#include <gtest/gtest.h>

namespace camloc {
namespace {

TEST(LeftOut, CountsAndNamesTheFirst) {
  std::vector<std::string> notes;
  LeftOut lines;
  lines.note("a.txt", "line", "without a pose", &notes);
  EXPECT_TRUE(notes.empty());
  lines.add(7);
  lines.note("a.txt", "line", "without a pose", &notes);
  lines.add(9);
  lines.note("a.txt", "line", "without a pose", &notes);
  lines.note("a.txt", "line", "without a pose", nullptr);
  ASSERT_EQ(notes.size(), 2U);
  EXPECT_EQ(notes[0], "a.txt: 1 line left out without a pose, line 7");
  EXPECT_EQ(notes[1], "a.txt: 2 lines left out without a pose, the first in line 7");
}

TEST(LeftOut, KnowsEveryProgramsSpellingOfNoNumber) {
  for (const char* word :
       {"nan", "NaN", "-nan", "nan(ind)", "-nan(snan)", "inf", "-Infinity", "1.#INF", "-1.#IND", "1.#QNAN", "None", "null"})
    EXPECT_TRUE(is_missing_number(word)) << word;
  for (const char* word : {"", "1", "-0", "1e9", "x", "n", "-"}) EXPECT_FALSE(is_missing_number(word)) << word;
}

}  // namespace
}  // namespace camloc
