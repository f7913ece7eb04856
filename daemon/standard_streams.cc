// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/standard_streams.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>

namespace camloc {
namespace {

constexpr const char* kOwnStderr = "/proc/self/fd/2";

void fill_closed_streams() {
  for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    // The lowest free number is the one that was found closed.
    if (::fcntl(fd, F_GETFD) < 0) static_cast<void>(::open("/dev/null", fd == STDIN_FILENO ? O_RDONLY : O_WRONLY));
  }
}

// O_NONBLOCK belongs to the open file, which is shared with whoever started the daemon. Opened anew, it is ours alone.
void open_stderr_anew() {
  const int fd = ::open(kOwnStderr, O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
  if (fd < 0) return;  // another user's: write_without_waiting() asks before it writes
  ::dup2(fd, STDERR_FILENO);
  ::close(fd);
}

}  // namespace

void guard_standard_streams() {
  ::signal(SIGPIPE, SIG_IGN);
  ::signal(SIGXFSZ, SIG_IGN);
  fill_closed_streams();
  struct stat info {};
  if (::fstat(STDERR_FILENO, &info) != 0) return;
  if (S_ISFIFO(info.st_mode) || ::isatty(STDERR_FILENO) == 1) open_stderr_anew();
  // The journal's socket cannot be opened again, and belongs to this service alone.
  if (S_ISSOCK(info.st_mode) && std::getenv("JOURNAL_STREAM") != nullptr) ::fcntl(STDERR_FILENO, F_SETFL, O_NONBLOCK);
}

bool write_without_waiting(int fd, std::string_view line) {
  ssize_t count = ::send(fd, line.data(), line.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  if (count < 0 && errno == ENOTSOCK) {
    // Without a reader a pipe would raise SIGPIPE; it says that it has room when a whole page is free.
    pollfd room{fd, POLLOUT, 0};
    ::poll(&room, 1, 0);
    if ((room.revents & POLLERR) != 0) return false;
    if ((room.revents & POLLOUT) == 0 && (::fcntl(fd, F_GETFL) & O_NONBLOCK) == 0) return false;
    count = ::write(fd, line.data(), line.size());
  }
  return count == static_cast<ssize_t>(line.size());
}

}  // namespace camloc
