// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/text.h"

#include <gtest/gtest.h>

namespace camloc {
namespace {

TEST(Text, ContentLinesSkipCommentsAndKeepNumbers) {
  const auto lines = content_lines("\xEF\xBB\xBF# head\r\n\r\n  one two \r\n#no\nlast");
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0].text, "one two");
  EXPECT_EQ(lines[0].number, 3);
  EXPECT_EQ(lines[1].text, "last");
  EXPECT_EQ(lines[1].number, 5);
}

TEST(Text, FieldsBetweenRunsOfSeparators) {
  EXPECT_EQ(split_fields("a  b,\tc "), (std::vector<std::string_view>{"a", "b", "c"}));
  EXPECT_TRUE(split_fields(" , ").empty());
}

TEST(Text, NumbersAreTheWholeText) {
  EXPECT_EQ(parse_double("-1.5e2"), -150.0);
  EXPECT_EQ(parse_double("+2"), 2.0);
  for (const char* bad : {"", "1.0x", " 1", "0x10", "+-1", "1,5"}) EXPECT_FALSE(parse_double(bad)) << bad;
  EXPECT_EQ(parse_int("-12"), -12);
  for (const char* bad : {"", "1.0", "99999999999999999999"}) EXPECT_FALSE(parse_int(bad)) << bad;
}

TEST(Text, SecondsKeepEveryNanosecond) {
  EXPECT_EQ(parse_seconds_ns("1305031229.528748"), 1305031229528748000);
  EXPECT_EQ(parse_seconds_ns("1305031229.123456789"), 1305031229123456789);
  EXPECT_EQ(parse_seconds_ns("1305031229.1234567891"), 1305031229123456789);
  EXPECT_EQ(parse_seconds_ns("-0.5"), -500000000);
  EXPECT_EQ(parse_seconds_ns(".25"), 250000000);
  EXPECT_EQ(parse_seconds_ns("7"), 7000000000);
  EXPECT_EQ(parse_seconds_ns("1.305e+09"), 1305000000000000000);
}

TEST(Text, StampsThatAreNotSeconds) {
  for (const char* bad : {"", ".", "-", "1403636579763555584", "1e30", "nan", "inf", "nane", "1.2.3", "1:30", "12,5", "--1"}) {
    EXPECT_FALSE(parse_seconds_ns(bad)) << bad;
  }
}

TEST(Text, DoubleQuotesEscapeWhatTomlAndJsonDoNotTake) {
  EXPECT_EQ(in_double_quotes("a \"b\" \\ \n\x7f"), "\"a \\\"b\\\" \\\\ \\u000a\\u007f\"");
  EXPECT_EQ(in_double_quotes("\xc3\xa4"), "\"\xc3\xa4\"");
  EXPECT_EQ(in_double_quotes("\xc3\xa4", true), "\"\\u00c3\\u00a4\"");
}

TEST(Text, StampedRowsAreNumbersInOrderOfTime) {
  const auto message_of = [](const char* text) {
    const auto no_negatives = [](std::int64_t, std::span<const double> values) {
      return values[1] < 0 ? Status(ErrorCode::kInvalid, "below zero") : Status::ok();
    };
    return read_stamped_rows(text, "a.txt", "timestamp x y", "a length", 9, no_negatives).message();
  };
  EXPECT_EQ(message_of("# x\n1 2 3\n1,9,9\n"), "");
  EXPECT_EQ(message_of("1 2\n"), "a.txt:1: 2 fields, expected 'timestamp x y'");
  EXPECT_EQ(message_of("1 2 3\n\n1 2 10\n"), "a.txt:3: '10' is not a length");
  EXPECT_EQ(message_of("1 2 3\n2 2 -1\n"), "a.txt:2: below zero");
  EXPECT_EQ(message_of("2 2 3\n1 2 3\n"), "a.txt:2: stamp is before the one above it; sort the file by time");
}

TEST(Text, NothingPrintableDrivesATerminal) {
  EXPECT_EQ(printable("a b~\xc3\xa4\xe2\x82\xac\xf0\x9f\x98\x80"), "a b~\xc3\xa4\xe2\x82\xac\xf0\x9f\x98\x80");
  EXPECT_EQ(printable("\x1b]0;x\x07\x7f\t\n"), "?]0;x????");
  EXPECT_EQ(printable("\xc2\x9b"
                      "2J \xc2\xa0"),
            "??2J \xc2\xa0")
      << "CSI as UTF-8";
  EXPECT_EQ(printable("\x9b"
                      "2J"),
            "?2J")
      << "CSI as a byte";
  EXPECT_EQ(printable("\xe2\x80\xae.\xe2\x80\xa8.\xe2\x81\xa6.\xef\xbb\xbf"), "???.???.???.???") << "turns, breaks, isolates";
  EXPECT_EQ(printable("\xc0\x9b.\xe0\x80\x9b.\xed\xa0\x80.\xf4\x90\x80\x80.\xe2\x82"), "??.???.???.????.??")
      << "overlong, no character, cut";
  EXPECT_EQ(printable(std::string("\0a", 2)), "?a");
}

TEST(Text, MessagesStayOnOneLine) {
  EXPECT_EQ(in_quotes("a\nb"), "'a?b'");
  EXPECT_LT(in_quotes(std::string(500, 'x')).size(), 60U);
  EXPECT_EQ(in_quotes(std::string(39, 'x') + "\xc3\xa4"), "'" + std::string(39, 'x') + "?...'") << "half a character";
  EXPECT_EQ(line_error("file.txt", 3, "bad").message(), "file.txt:3: bad");
}

}  // namespace
}  // namespace camloc
