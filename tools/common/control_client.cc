// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/common/control_client.h"

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "core/base/unique_fd.h"

namespace camloc::tools {
namespace {

constexpr std::size_t kMaxAnswerBytes = 1 << 20;

Status connect_error(const std::string& path, int error) {
  switch (error) {
    case ENOENT:
    case ECONNREFUSED:
      return {ErrorCode::kUnavailable,
              "no camlocd listens on " + path + "; start it with 'systemctl start camlocd' or name its socket with --socket"};
    case EACCES:
    case EPERM: return {ErrorCode::kIo, "not permitted to use " + path + "; become a member of the socket's group (see 'ls -l') or root"};
    default: return {ErrorCode::kIo, "cannot connect to " + path + ": " + std::strerror(error)};
  }
}

/// Bytes up to the first newline or the end of the stream.
Result<std::string> read_line(int fd, std::chrono::steady_clock::time_point deadline) {
  std::string line;
  while (line.size() < kMaxAnswerBytes) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now()).count();
    pollfd waiting{fd, POLLIN, 0};
    const int ready = left <= 0 ? 0 : ::poll(&waiting, 1, static_cast<int>(left));
    if (ready < 0 && errno == EINTR) continue;
    if (ready <= 0) return {ErrorCode::kTimeout, "camlocd did not answer in time"};
    std::array<char, 4096> bytes{};
    const ssize_t count = ::recv(fd, bytes.data(), bytes.size(), 0);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return {ErrorCode::kIo, std::string("reading camlocd's answer: ") + std::strerror(errno)};
    line.append(bytes.data(), static_cast<std::size_t>(count));
    const std::size_t newline = line.find('\n');
    if (newline != std::string::npos) return line.substr(0, newline);
    if (count == 0) return line;
  }
  return {ErrorCode::kCorrupt, "camlocd's answer does not end"};
}

}  // namespace

Result<nlohmann::ordered_json> control_request(const std::string& socket_path, const std::string& command,
                                               std::chrono::milliseconds timeout) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (socket_path.empty() || socket_path.size() >= sizeof(address.sun_path)) {
    return {ErrorCode::kInvalid, "socket path '" + socket_path + "' is empty or longer than 107 bytes"};
  }
  socket_path.copy(address.sun_path, socket_path.size());
  const UniqueFd fd(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  if (!fd.is_open()) return {ErrorCode::kIo, std::string("cannot make a socket: ") + std::strerror(errno)};
  if (::connect(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) return connect_error(socket_path, errno);

  const std::string line = command + "\n";
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  if (::send(fd.get(), line.data(), line.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(line.size())) {
    return {ErrorCode::kIo, "cannot write to " + socket_path + ": " + std::strerror(errno)};
  }
  auto answer = read_line(fd.get(), deadline);
  if (!answer) return answer.status().with_context(socket_path);
  auto json = nlohmann::ordered_json::parse(*answer, nullptr, false);
  if (!json.is_object()) return {ErrorCode::kCorrupt, socket_path + ": the answer is not a JSON object; is this camlocd?"};
  return json;
}

}  // namespace camloc::tools
