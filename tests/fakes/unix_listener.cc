// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// socket, bind, listen.
#include "tests/fakes/unix_listener.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace camloc::fakes {

Result<UniqueFd> listen_at(const std::string& path, int backlog, int flags) {
  sockaddr_un name{};
  name.sun_family = AF_UNIX;
  if (path.size() >= sizeof name.sun_path) return {ErrorCode::kInvalid, path + ": too long for a socket's name"};
  std::memcpy(name.sun_path, path.c_str(), path.size() + 1);
  ::unlink(path.c_str());
  UniqueFd fd(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | flags, 0));
  if (!fd.is_open() || ::bind(fd.get(), reinterpret_cast<const sockaddr*>(&name), sizeof name) != 0 || ::listen(fd.get(), backlog) != 0)
    return {ErrorCode::kIo, path + ": no socket: " + std::strerror(errno)};
  return fd;
}

}  // namespace camloc::fakes
