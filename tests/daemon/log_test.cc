// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Log lines, their prefix, and what holds a flood back.
#include "daemon/log.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <thread>

#include "core/base/unique_fd.h"

namespace camloc {
namespace {

class LogTest : public ::testing::Test {
 protected:
  LogTest() {
    std::array<int, 2> ends{};
    EXPECT_EQ(::pipe2(ends.data(), O_NONBLOCK | O_CLOEXEC), 0);
    read_end_.reset(ends[0]);
    write_end_.reset(ends[1]);
  }
  std::string written() {
    std::string text(60000, '\0');
    const ssize_t count = ::read(read_end_.get(), text.data(), text.size());
    text.resize(static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
    return text;
  }
  UniqueFd read_end_, write_end_;
};

TEST_F(LogTest, PrefixForTheJournalAndForPeople) {
  Log journal(LogLevel::kInfo, write_end_.get(), true);
  journal.write(LogLevel::kError, "a %d", 1);
  journal.write(LogLevel::kWarning, "b");
  journal.write(LogLevel::kInfo, "c");
  EXPECT_EQ(written(), "<3>a 1\n<4>b\n<6>c\n");
  Log plain(LogLevel::kInfo, write_end_.get(), false);
  plain.write(LogLevel::kInfo, "c");
  EXPECT_EQ(written(), "camlocd: info: c\n");
}

TEST_F(LogTest, LevelFilters) {
  Log log(LogLevel::kWarning, write_end_.get(), true);
  log.write(LogLevel::kInfo, "no");
  log.write(LogLevel::kWarning, "yes");
  log.set_level(LogLevel::kError);
  log.write(LogLevel::kWarning, "no");
  EXPECT_EQ(written(), "<4>yes\n");
}

TEST_F(LogTest, ALineStaysALine) {
  Log log(LogLevel::kInfo, write_end_.get(), true);
  log.write(LogLevel::kInfo, "%s", "a\nb\r<3>c");
  EXPECT_EQ(written(), "<6>a b <3>c\n");
  log.write(LogLevel::kInfo, "%s", std::string(5000, 'x').c_str());
  const std::string line = written();
  EXPECT_LT(line.size(), 1100U);
  EXPECT_EQ(std::count(line.begin(), line.end(), '\n'), 1);
}

TEST_F(LogTest, FloodIsHeldBackAndCounted) {
  Log log(LogLevel::kInfo, write_end_.get(), true);
  for (int i = 0; i < 1000; ++i) log.write(LogLevel::kInfo, "flood");
  const std::string text = written();
  EXPECT_LT(std::count(text.begin(), text.end(), '\n'), 900);
  EXPECT_GE(std::count(text.begin(), text.end(), '\n'), 30);
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  log.write(LogLevel::kInfo, "after");
  EXPECT_NE(written().find("lines held back"), std::string::npos);
}

TEST_F(LogTest, WhatDrivesATerminalIsMarked) {
  Log log(LogLevel::kInfo, write_end_.get(), true);
  log.write(LogLevel::kInfo, "map %s", "\x1b[2J\x9b\xc3\xa4");
  EXPECT_EQ(written(), "<6>map ?[2J?\xc3\xa4\n");
}

/// A pipe that blocks, filled to the last byte, as a reader that stopped leaves it.
TEST_F(LogTest, AFullPipeLosesLinesAndThenSaysHowMany) {
  ASSERT_EQ(::fcntl(write_end_.get(), F_SETPIPE_SZ, 8192), 8192);
  while (::write(write_end_.get(), "x", 1) == 1) {}
  ASSERT_EQ(::fcntl(write_end_.get(), F_SETFL, 0), 0);
  Log log(LogLevel::kInfo, write_end_.get(), true);
  for (int i = 0; i < 3; ++i) log.write(LogLevel::kInfo, "lost");
  EXPECT_EQ(log.num_lost(), 3);
  static_cast<void>(written());
  log.write(LogLevel::kInfo, "again");
  EXPECT_EQ(written(), "<4>3 lines lost, nobody took them\n<6>again\n");
  log.write(LogLevel::kInfo, "more");
  EXPECT_EQ(written(), "<6>more\n");
  EXPECT_EQ(log.num_lost(), 3);
}

TEST_F(LogTest, AClosedPipeAndAFullDiskLoseLines) {
  read_end_.reset();
  Log to_nobody(LogLevel::kInfo, write_end_.get(), true);
  to_nobody.write(LogLevel::kInfo, "lost");  // SIGPIPE would end this test
  EXPECT_EQ(to_nobody.num_lost(), 1);
  const UniqueFd full(::open("/dev/full", O_WRONLY | O_CLOEXEC));
  Log to_full(LogLevel::kInfo, full.get(), true);
  to_full.write(LogLevel::kInfo, "lost");
  EXPECT_EQ(to_full.num_lost(), 1);
}

TEST(RepeatFilterTest, OnlyNewTextsPass) {
  RepeatFilter filter;
  EXPECT_TRUE(filter.is_new("a"));
  EXPECT_FALSE(filter.is_new("a"));
  EXPECT_TRUE(filter.is_new("b"));
  EXPECT_TRUE(filter.is_new("a"));
  filter.clear();
  EXPECT_TRUE(filter.is_new("a"));
}

}  // namespace
}  // namespace camloc
