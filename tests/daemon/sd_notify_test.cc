// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The notifications as a service manager receives them, and when the watchdog may be fed.
#include "daemon/sd_notify.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <array>
#include <cstdlib>
#include <cstring>

#include "tests/daemon/test_folder.h"

namespace camloc {
namespace {

/// A manager's socket, named in the environment for the time of a test.
class SdNotifyTest : public ::testing::Test {
 protected:
  SdNotifyTest() : path_(folder_.file("notify")), socket_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, path_.c_str(), path_.size());
    EXPECT_EQ(::bind(socket_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
    ::setenv("NOTIFY_SOCKET", path_.c_str(), 1);
    ::unsetenv("WATCHDOG_USEC");
    ::unsetenv("WATCHDOG_PID");
  }
  ~SdNotifyTest() override {
    for (const char* name : {"NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID"}) ::unsetenv(name);
  }
  std::string heard() {
    std::array<char, 2000> bytes{};
    const ssize_t count = ::recv(socket_.get(), bytes.data(), bytes.size(), 0);
    return count < 0 ? "nothing" : std::string(bytes.data(), static_cast<std::size_t>(count));
  }

  testing::TestFolder folder_;
  std::string path_;
  UniqueFd socket_;
};

TEST_F(SdNotifyTest, SaysWhatTheProtocolWants) {
  Notifier notifier;
  notifier.ready("fine");
  EXPECT_EQ(heard(), "READY=1\nSTATUS=fine");
  notifier.status("busy");
  EXPECT_EQ(heard(), "STATUS=busy");
  notifier.reloading();
  EXPECT_EQ(heard().find("RELOADING=1\nMONOTONIC_USEC="), 0U);
  notifier.watchdog();
  EXPECT_EQ(heard(), "WATCHDOG=1");
  notifier.stopping();
  EXPECT_EQ(heard(), "STOPPING=1");
}

TEST_F(SdNotifyTest, LongTextIsCut) {
  Notifier notifier;
  notifier.status(std::string(5000, 'x').c_str());
  EXPECT_LT(heard().size(), 700U);
}

TEST_F(SdNotifyTest, WatchdogPeriodIsForThisProcessOnly) {
  EXPECT_EQ(Notifier().watchdog_ns(), 0);
  ::setenv("WATCHDOG_USEC", "2000000", 1);
  EXPECT_EQ(Notifier().watchdog_ns(), 2'000'000'000);
  ::setenv("WATCHDOG_PID", std::to_string(getpid()).c_str(), 1);
  EXPECT_EQ(Notifier().watchdog_ns(), 2'000'000'000);
  ::setenv("WATCHDOG_PID", "1", 1);
  EXPECT_EQ(Notifier().watchdog_ns(), 0);
  ::unsetenv("WATCHDOG_PID");
  for (const char* nonsense : {"", "x", "-5", "12x", "99999999999999999999"}) {
    ::setenv("WATCHDOG_USEC", nonsense, 1);
    EXPECT_EQ(Notifier().watchdog_ns(), 0) << nonsense;
  }
}

TEST_F(SdNotifyTest, WithoutAManagerNothingHappens) {
  ::unsetenv("NOTIFY_SOCKET");
  Notifier silent;
  silent.ready("");
  for (const char* path : {"relative", "", "/nowhere/at/all"}) {
    ::setenv("NOTIFY_SOCKET", path, 1);
    Notifier notifier;
    notifier.ready("");
  }
  ::setenv("NOTIFY_SOCKET", ("/" + std::string(200, 'x')).c_str(), 1);
  Notifier too_long;
  too_long.ready("");
  EXPECT_EQ(heard(), "nothing");
}

ProgressWatch::Counters counters(std::uint64_t turns, std::uint64_t captured, std::uint64_t processed, bool is_over = false) {
  return {turns, captured, processed, is_over};
}

TEST(ProgressWatchTest, FramesThroughTheWholePipeAreProgress) {
  ProgressWatch watch;
  EXPECT_TRUE(watch.has_progressed(counters(1, 1, 1)));
  EXPECT_TRUE(watch.has_progressed(counters(2, 2, 2)));
}

TEST(ProgressWatchTest, HangingCaptureStarvesTheWatchdog) {
  ProgressWatch watch;
  EXPECT_TRUE(watch.has_progressed(counters(5, 3, 3)));
  EXPECT_FALSE(watch.has_progressed(counters(5, 3, 3)));
  EXPECT_FALSE(watch.has_progressed(counters(5, 3, 3)));
  EXPECT_TRUE(watch.has_progressed(counters(6, 3, 3))) << "a time-out is progress too: no frame, but no hang";
}

TEST(ProgressWatchTest, FramesThatAreNotProcessedStarveTheWatchdog) {
  ProgressWatch watch;
  EXPECT_TRUE(watch.has_progressed(counters(5, 3, 3)));
  EXPECT_FALSE(watch.has_progressed(counters(9, 7, 3)));
  EXPECT_TRUE(watch.has_progressed(counters(9, 7, 4))) << "dropped frames count as long as newer ones are processed";
}

TEST(ProgressWatchTest, AnEndedRecordingIsAtRest) {
  ProgressWatch watch;
  EXPECT_TRUE(watch.has_progressed(counters(5, 3, 3, true)));
  EXPECT_TRUE(watch.has_progressed(counters(5, 3, 3, true)));
}

}  // namespace
}  // namespace camloc
