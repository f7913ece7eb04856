// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What becomes of 0, 1 and 2, in children whose streams are set up by the test; and a socket that nobody reads.
#include "daemon/standard_streams.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <functional>
#include <string>

#include "core/base/unique_fd.h"

namespace camloc {
namespace {

/// Whether `body` says so in a child, after `prepare` and guard_standard_streams().
bool in_guarded_child(const std::function<void()>& prepare, const std::function<bool()>& body) {
  const pid_t child = ::fork();
  if (child == 0) {
    prepare();
    guard_standard_streams();
    ::_exit(body() ? 0 : 1);
  }
  int status = 0;
  return ::waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

std::array<UniqueFd, 2> open_pipe() {
  std::array<int, 2> ends{};
  EXPECT_EQ(::pipe(ends.data()), 0);
  return {UniqueFd(ends[0]), UniqueFd(ends[1])};
}

TEST(StandardStreams, ClosedOnesAreFilledSoThatNoOtherFileTakesTheirPlace) {
  const auto close_all = [] {
    for (const int fd : {0, 1, 2}) ::close(fd);
  };
  EXPECT_TRUE(in_guarded_child(close_all, [] {
    return ::open("/dev/null", O_RDONLY) > 2 && ::write(1, "x", 1) == 1 && ::write(2, "x", 1) == 1;  // NOLINT: ends with the child
  }));
}

TEST(StandardStreams, AFullPipeBlocksNoLibraryThatPrints) {
  const auto [read_end, write_end] = open_pipe();
  const int fd = write_end.get();
  const auto fill = [fd] {
    ::dup2(fd, 2);
    ::alarm(20);  // a blocked child would stay for ever
  };
  EXPECT_TRUE(in_guarded_child(fill, [] {
    const std::string page(4096, 'x');
    for (int i = 0; i < 1000; ++i) {
      if (::write(2, page.data(), page.size()) < 0) return true;
    }
    return false;
  }));
  EXPECT_EQ(::fcntl(fd, F_GETFL) & O_NONBLOCK, 0) << "whoever shares the pipe has it as it was";
}

TEST(StandardStreams, AReaderThatEndedEndsNobody) {
  auto [read_end, write_end] = open_pipe();
  read_end.reset();
  const int fd = write_end.get();
  EXPECT_TRUE(in_guarded_child([fd] { ::dup2(fd, 2); }, [] { return ::write(2, "x", 1) < 0 && ::write(2, "x", 1) < 0; }));
}

TEST(StandardStreams, TheJournalsSocketIsNonBlockingAndNoOther) {
  std::array<int, 2> ends{};
  ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()), 0);
  const UniqueFd near(ends[0]), far(ends[1]);
  const int fd = near.get();
  const auto is_nonblocking = [] { return (::fcntl(2, F_GETFL) & O_NONBLOCK) != 0; };
  EXPECT_FALSE(in_guarded_child(
      [fd] {
        ::unsetenv("JOURNAL_STREAM");
        ::dup2(fd, 2);
      },
      is_nonblocking));
  EXPECT_TRUE(in_guarded_child(
      [fd] {
        ::setenv("JOURNAL_STREAM", "1:1", 1);
        ::dup2(fd, 2);
      },
      is_nonblocking));
}

TEST(StandardStreams, ASocketThatNobodyReadsOrThatIsClosedLosesLines) {
  std::array<int, 2> ends{};
  ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()), 0);
  UniqueFd near(ends[0]), far(ends[1]);
  EXPECT_TRUE(write_without_waiting(near.get(), "read by nobody\n"));
  int num_written = 1;
  while (num_written < 100'000 && write_without_waiting(near.get(), std::string(1000, 'x'))) ++num_written;
  EXPECT_LT(num_written, 100'000);
  far.reset();
  EXPECT_FALSE(write_without_waiting(near.get(), "x")) << "and no SIGPIPE";
}

}  // namespace
}  // namespace camloc
