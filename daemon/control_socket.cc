// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Listening, and serving a handful of clients without ever waiting for one.
#include "daemon/control_socket.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

namespace camloc {
namespace {

constexpr mode_t kMode = 0660;

Status io_error(const std::string& what, const std::string& path) {
  return {ErrorCode::kIo, what + " " + path + ": " + std::strerror(errno)};
}

Status in_use(const std::string& path) {
  return {ErrorCode::kUnavailable,
          "control socket " + path + " is in use: another camlocd runs; stop it or set control.socket to another path"};
}

UniqueFd stream_socket() { return UniqueFd(::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)); }

/// Makes room for bind(): nothing there, or a dead socket that is removed.
Status remove_stale(const std::string& path, const sockaddr_un& address) {
  struct stat info {};
  if (::lstat(path.c_str(), &info) != 0) return errno == ENOENT ? Status::ok() : io_error("cannot look at", path);
  if (!S_ISSOCK(info.st_mode)) {
    return {ErrorCode::kInvalid, "control socket " + path + ": a file of that name exists and is not a socket"};
  }
  const UniqueFd probe = stream_socket();
  const int rc = ::connect(probe.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address));
  if (rc == 0 || errno != ECONNREFUSED) return in_use(path);
  return ::unlink(path.c_str()) == 0 ? Status::ok() : io_error("cannot remove the stale socket", path);
}

}  // namespace

Result<std::unique_ptr<ControlSocket>> ControlSocket::open(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof(address.sun_path)) {
    return Status(ErrorCode::kInvalid, "control socket " + path + ": paths of sockets are limited to 107 bytes");
  }
  std::memcpy(address.sun_path, path.data(), path.size());

  UniqueFd lock(::open((path + ".lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, kMode));
  if (!lock.is_open()) return io_error("cannot open", path + ".lock");
  if (::flock(lock.get(), LOCK_EX | LOCK_NB) != 0) return errno == EWOULDBLOCK ? in_use(path) : io_error("cannot lock", path + ".lock");
  if (const Status status = remove_stale(path, address); !status) return status;

  UniqueFd listener = stream_socket();
  if (!listener.is_open()) return io_error("cannot create socket", path);
  // The inode inherits the descriptor's mode at bind(): never a moment of wider permissions. chmod() then undoes the umask.
  ::fchmod(listener.get(), kMode);
  if (::bind(listener.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) return io_error("cannot bind", path);
  if (::chmod(path.c_str(), kMode) != 0 || ::listen(listener.get(), kMaxClients) != 0) return io_error("cannot listen on", path);
  return std::unique_ptr<ControlSocket>(new ControlSocket(path, std::move(lock), std::move(listener)));
}

ControlSocket::ControlSocket(std::string path, UniqueFd lock, UniqueFd listener)
    : path_(std::move(path)), lock_(std::move(lock)), listener_(std::move(listener)) {}

// The lock file stays: removing it would let two daemons hold locks on two different files of that name.
ControlSocket::~ControlSocket() { ::unlink(path_.c_str()); }

int ControlSocket::prepare_poll(std::span<pollfd> fds) {
  int count = 0;
  for (const Client& client : clients_) {
    if (!client.fd.is_open()) continue;
    const short events = client.reply.empty() ? POLLIN : POLLOUT;
    fds[static_cast<std::size_t>(count++)] = {client.fd.get(), events, 0};
  }
  // With all places taken new clients wait in the kernel's queue.
  if (count < kMaxClients && !is_resting_) fds[static_cast<std::size_t>(count++)] = {listener_.get(), POLLIN, 0};
  return count;
}

void ControlSocket::handle(std::span<const pollfd> fds, std::int64_t now_ns, const ControlHandler& handler) {
  bool has_new_client = false;
  for (const pollfd& ready : fds) {
    if (ready.revents == 0) continue;
    if (ready.fd == listener_.get()) {
      has_new_client = true;
      continue;
    }
    const auto client = std::find_if(clients_.begin(), clients_.end(), [&](const Client& c) { return c.fd.get() == ready.fd; });
    if (client == clients_.end()) continue;
    if (!client->reply.empty() || read_request(*client, handler)) write_reply(*client);
  }
  if (has_new_client) accept_clients(now_ns);
}

void ControlSocket::expire(std::int64_t now_ns) {
  is_resting_ = false;
  const std::int64_t spare_ns = is_somebody_waiting() ? kPatience_ns - kCrowded_ns : 0;
  for (Client& client : clients_) {
    if (!client.fd.is_open() || now_ns + spare_ns <= client.deadline_ns) continue;
    // What it said while the daemon was busy with something else was not read yet: that is not its fault.
    if (std::exchange(client.is_overdue, true)) close_client(client);
  }
}

bool ControlSocket::is_somebody_waiting() const {
  if (!std::all_of(clients_.begin(), clients_.end(), [](const Client& c) { return c.fd.is_open(); })) return false;
  pollfd queue{listener_.get(), POLLIN, 0};
  return ::poll(&queue, 1, 0) == 1;
}

void ControlSocket::accept_clients(std::int64_t now_ns) {
  for (Client& client : clients_) {
    if (client.fd.is_open()) continue;
    client.fd.reset(::accept4(listener_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
    if (!client.fd.is_open()) {
      // Out of descriptors or memory the listener stays readable, and waiting for it would never wait.
      is_resting_ = errno != EAGAIN && errno != ECONNABORTED && errno != EINTR;
      return;
    }
    client.num_read = client.num_written = 0;
    client.reply.clear();
    client.is_overdue = false;
    client.deadline_ns = now_ns + kPatience_ns;
  }
}

// True when there is a reply to write.
bool ControlSocket::read_request(Client& client, const ControlHandler& handler) {
  char* const end = client.request.data() + client.num_read;
  const ssize_t count = ::recv(client.fd.get(), end, kMaxRequest - client.num_read, 0);
  if (count < 0 && (errno == EAGAIN || errno == EINTR)) return false;
  if (count < 0 || (count == 0 && client.num_read == 0)) {
    close_client(client);
    return false;
  }
  client.num_read += static_cast<std::size_t>(count);
  const std::string_view text(client.request.data(), client.num_read);
  const std::size_t line_end = text.find('\n');
  // A client that closes its side has said all it wants to, line feed or not.
  if (line_end == std::string_view::npos && count > 0 && text.size() < kMaxRequest) return false;
  if (line_end == std::string_view::npos && text.size() == kMaxRequest) {
    client.reply = control_reply(Status(ErrorCode::kInvalid, "request too long"));
  } else {
    const Result<ControlRequest> request = parse_control_request(text.substr(0, line_end));
    client.reply = request ? handler(*request) : control_reply(request.status());
  }
  client.reply += '\n';
  return true;
}

void ControlSocket::write_reply(Client& client) {
  const char* const rest = client.reply.data() + client.num_written;
  const ssize_t count = ::send(client.fd.get(), rest, client.reply.size() - client.num_written, MSG_NOSIGNAL);
  if (count < 0 && (errno == EAGAIN || errno == EINTR)) return;
  if (count > 0) client.num_written += static_cast<std::size_t>(count);
  if (count < 0 || client.num_written == client.reply.size()) close_client(client);
}

void ControlSocket::close_client(Client& client) {
  // Unread input would turn the client's end of file into "connection reset"; swallow a bounded amount of it.
  std::array<char, 4096> waste{};
  for (int i = 0; i < 16 && ::recv(client.fd.get(), waste.data(), waste.size(), 0) > 0; ++i) {}
  client.fd.reset();
  client.reply = std::string();
}

}  // namespace camloc
