// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The buffer between a file and its reader: nothing is lost at its ends, and an observer may end it.
#include "tools/mapping/cloud/cloud_input.h"

#include <gtest/gtest.h>

#include <sstream>

#include "tests/base/recording_observer.h"
#include "tests/mapping/cloud_bytes.h"

namespace camloc::mapping {
namespace {

TEST(CloudInputTest, StopsWhenAskedTo) {
  std::string text;
  for (int i = 0; i < 200000; ++i) text += "1.25 2.25 3.25\n";
  std::istringstream stream(text);
  testing::RecordingObserver observer(2);
  const auto cloud = read_cloud(stream, "a.xyz", {}, observer);
  ASSERT_EQ(observer.steps.size(), 2U);
  EXPECT_EQ(observer.steps[0].what, "reading the cloud: 0 of 3 MB");
  EXPECT_EQ(observer.steps[1].what, "reading the cloud: 1 of 3 MB");
  expect_error(cloud, ErrorCode::kIo, "interrupted");
}

TEST(CloudInputTest, LinesEndInThreeWaysAndAcrossTheBuffer) {
  std::string text;
  for (int i = 0; i < 200000; ++i) text += "line " + std::to_string(i) + (i % 3 == 0 ? "\n" : i % 3 == 1 ? "\r\n" : "\r");
  std::istringstream stream(text + "last");
  CloudInput input(stream, "a.txt");
  EXPECT_EQ(input.total(), text.size() + 4);
  for (int i = 0; i < 200000; ++i) {
    const auto line = input.read_line();
    ASSERT_TRUE(line && *line == "line " + std::to_string(i)) << i;
  }
  EXPECT_EQ(input.position(), text.size());
  EXPECT_EQ(input.read_line(), "last");
  EXPECT_FALSE(input.read_line());
  EXPECT_EQ(input.remaining(), 0U);
}

TEST(CloudInputTest, BytesComeInOrderAndNoneBehindTheEnd) {
  std::string bytes(3'000'000, '\0');
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i * 7 % 251);
  std::istringstream stream(bytes);
  CloudInput input(stream, "a.bin");
  EXPECT_EQ(input.peek(4).size(), 4U);
  EXPECT_EQ(input.position(), 0U);
  std::uint64_t at = 0;
  for (const std::size_t size : {1UL, 60000UL, 65536UL}) {
    for (int i = 0; i < 5; ++i, at += size) {
      const auto read = input.read(size);
      ASSERT_EQ(read.size(), size);
      ASSERT_EQ(static_cast<char>(read.front()), bytes[at]);
      ASSERT_EQ(static_cast<char>(read.back()), bytes[at + size - 1]);
    }
  }
  EXPECT_TRUE(input.skip(bytes.size() - at - 3));
  EXPECT_EQ(input.peek(10).size(), 3U);
  EXPECT_TRUE(input.read(4).empty());
  EXPECT_FALSE(input.skip(4));
  EXPECT_TRUE(input.skip(3));
  EXPECT_EQ(input.truncated("no end").code(), ErrorCode::kCorrupt);
}

TEST(CloudInputTest, AnEndlessLineIsCut) {
  std::istringstream stream(std::string(3 * CloudInput::kMaxLine, 'x'));
  CloudInput input(stream, "a.txt");
  for (int i = 0; i < 3; ++i) EXPECT_EQ(input.read_line()->size(), CloudInput::kMaxLine);
  EXPECT_FALSE(input.read_line());
}

}  // namespace
}  // namespace camloc::mapping
