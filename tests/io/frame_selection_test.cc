// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>

#include "core/io/sequence.h"

namespace camloc {
namespace {

using Indices = std::vector<std::size_t>;

Indices select(const std::string& include, const std::string& exclude, std::size_t n) {
  const auto result = select_frames(include, exclude, n);
  EXPECT_TRUE(result.is_ok()) << result.status().message();
  return result ? *result : Indices{999999};
}

TEST(FrameSelection, EmptyMeansAllAndNone) {
  EXPECT_EQ(select("", "", 3), (Indices{0, 1, 2}));
  EXPECT_EQ(select("", ":", 3), Indices{});
  EXPECT_EQ(select("", "", 0), Indices{});
  EXPECT_EQ(select("::", "", 0), Indices{});
}

// Expected values are what Python prints for sorted(range(10)[slice]).
TEST(FrameSelection, PythonSlices) {
  const struct {
    const char* text;
    Indices expected;
  } cases[] = {
      {"2:5", {2, 3, 4}},
      {":3", {0, 1, 2}},
      {"7:", {7, 8, 9}},
      {"::4", {0, 4, 8}},
      {"1::4", {1, 5, 9}},
      {"-3:", {7, 8, 9}},
      {":-8", {0, 1}},
      {"-5:-3", {5, 6}},
      {"5:2", {}},
      {"8:100", {8, 9}},
      {"-100:2", {0, 1}},
      {"100:", {}},
      {"::-1", {0, 1, 2, 3, 4, 5, 6, 7, 8, 9}},
      {"::-4", {1, 5, 9}},
      {"8:2:-3", {5, 8}},
      {"2:8:-1", {}},
      {"-1:-4:-1", {7, 8, 9}},
      {"100::-5", {4, 9}},
      {":-3:-1", {8, 9}},
      {"0:10:100", {0}},
      {"3", {3}},
      {"-1", {9}},
      {" 2 : 4 ", {2, 3}},
      {"5:-100:-5", {0, 5}},
  };
  for (const auto& one : cases) EXPECT_EQ(select(one.text, "", 10), one.expected) << one.text;
}

TEST(FrameSelection, HugeNumbersDoNotWrap) {
  EXPECT_EQ(select("-9223372036854775808:9223372036854775807:9223372036854775807", "", 4), (Indices{0}));
  EXPECT_EQ(select("::-9223372036854775808", "", 4), (Indices{3}));
}

TEST(FrameSelection, AgreesWithTheDefinitionOnManySlices) {
  constexpr int kSize = 7;
  for (int start = -9; start <= 9; ++start) {
    for (int stop = -9; stop <= 9; ++stop) {
      for (int step : {-3, -1, 1, 2}) {
        // The language reference: negative bounds count from the end, then i = start + k * step up to stop.
        Indices expected;
        const int low = step < 0 ? -1 : 0, high = step < 0 ? kSize - 1 : kSize;
        int i = std::clamp(start < 0 ? start + kSize : start, low, high);
        const int end = std::clamp(stop < 0 ? stop + kSize : stop, low, high);
        for (; step > 0 ? i < end : i > end; i += step) expected.push_back(static_cast<std::size_t>(i));
        std::sort(expected.begin(), expected.end());
        const std::string text = std::to_string(start) + ":" + std::to_string(stop) + ":" + std::to_string(step);
        EXPECT_EQ(select(text, "", kSize), expected) << text;
      }
    }
  }
}

TEST(FrameSelection, SeveralPartsAreAUnion) {
  EXPECT_EQ(select("0:2,8:,1", "", 10), (Indices{0, 1, 8, 9}));
  EXPECT_EQ(select("", "::2,1", 6), (Indices{3, 5}));
  EXPECT_EQ(select("0:4", "1:3", 10), (Indices{0, 3}));
}

TEST(FrameSelection, ErrorsShowTheOffendingText) {
  const struct {
    const char* text;
    const char* part;
  } cases[] = {
      {"a:b", "'a'"},
      {"1:2:0", "'1:2:0'"},
      {"1:2:3:4", "'1:2:3:4'"},
      {"1,,2", "'1,,2'"},
      {"12", "'12'"},
      {"-11", "'-11'"},
      {"1.5:", "'1.5'"},
      {"0:3,x", "'x'"},
      {",", "','"},
      {"99999999999999999999:", "'99999999999999999999'"},
  };
  for (const auto& one : cases) {
    const auto result = select_frames(one.text, "", 10);
    ASSERT_FALSE(result.is_ok()) << one.text;
    EXPECT_EQ(result.status().code(), ErrorCode::kInvalid);
    EXPECT_NE(result.status().message().find(one.part), std::string::npos) << result.status().message();
    EXPECT_FALSE(select_frames("", one.text, 10).is_ok());
  }
}

}  // namespace
}  // namespace camloc
