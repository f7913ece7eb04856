// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What an observer shows on a terminal (a pseudo terminal here), and how it is stopped.
#include "tools/common/terminal_observer.h"

#include <gtest/gtest.h>
#include <poll.h>
#include <pty.h>
#include <unistd.h>

#include <csignal>
#include <string>

namespace camloc::tools {
namespace {

/// What is written to stderr while this lives, as a terminal gets it.
class Terminal {
 public:
  Terminal() {
    int slave = -1;
    EXPECT_EQ(::openpty(&master_, &slave, nullptr, nullptr, nullptr), 0);
    old_ = ::dup(STDERR_FILENO);
    ::dup2(slave, STDERR_FILENO);
    ::close(slave);
  }
  ~Terminal() {
    ::dup2(old_, STDERR_FILENO);
    ::close(old_);
    ::close(master_);
  }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;
  /// What was written, once it ends in `ending` (or 5 s are over): the kernel hands it over when it finds the time.
  std::string text_until(const std::string& ending) const {
    std::string text;
    pollfd ready = {master_, POLLIN, 0};
    while (!text.ends_with(ending) && ::poll(&ready, 1, 5000) == 1) {
      char bytes[4096];
      const ssize_t count = ::read(master_, bytes, sizeof bytes);
      if (count <= 0) break;
      text.append(bytes, static_cast<std::size_t>(count));
    }
    return text;
  }

 private:
  int master_ = -1, old_ = -1;
};

TEST(TerminalObserverTest, CountsHaveABarAndStagesAText) {
  const Terminal terminal;
  {
    TerminalObserver observer;
    EXPECT_TRUE(observer.on_progress("frame", 4, 4, "3 localized"));
    const std::string text = terminal.text_until(" s left");
    EXPECT_NE(text.find("[########################] frame 4/4  3 localized"), std::string::npos) << text;
    EXPECT_TRUE(observer.on_progress("frame", 12));
    EXPECT_TRUE(terminal.text_until("frame 12").ends_with("frame 12"));
    EXPECT_TRUE(observer.on_progress("adjusting ..."));
    EXPECT_TRUE(terminal.text_until("adjusting ...").ends_with("adjusting ..."));
  }
  EXPECT_EQ(terminal.text_until("\x1b[K"), "\r\x1b[K") << "the line is cleared";
}

TEST(TerminalObserverTest, WithoutATerminalItIsSilent) {
  ::testing::internal::CaptureStderr();
  {
    TerminalObserver observer;
    EXPECT_TRUE(observer.on_progress("frame", 4, 4));
    EXPECT_TRUE(observer.on_progress("adjusting ..."));
  }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

TEST(TerminalObserverTest, ASignalIsTheWishToStop) {
  TerminalObserver observer;
  EXPECT_FALSE(observer.should_stop());
  std::raise(SIGINT);
  EXPECT_TRUE(observer.should_stop());
  EXPECT_FALSE(observer.on_progress("frame", 1, 9));
}

TEST(InterruptGuardTest, ASignalSetsTheFlagAndANewGuardForgetsIt) {
  {
    const InterruptGuard guard;
    EXPECT_FALSE(InterruptGuard::is_interrupted());
    std::raise(SIGTERM);
    EXPECT_TRUE(InterruptGuard::is_interrupted());
  }
  const InterruptGuard guard;
  EXPECT_FALSE(InterruptGuard::is_interrupted());
}

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
