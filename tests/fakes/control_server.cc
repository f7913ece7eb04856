// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/fakes/control_server.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>

#include "core/io/text.h"
#include "tests/fakes/unix_listener.h"

namespace camloc::fakes {
namespace {

constexpr int kPollMs = 20;
constexpr std::size_t kMaxLine = 4096;

std::int64_t monotonic_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

Result<TimedCommand> parse_timed_command(const std::string& text) {
  const std::size_t colon = text.find(':');
  const auto seconds = parse_double(std::string_view(text).substr(0, std::min(colon, text.size())));
  if (colon == std::string::npos || !seconds || !(*seconds >= 0)) return {ErrorCode::kInvalid, "not SECONDS:COMMAND: " + in_quotes(text)};
  return TimedCommand{*seconds, text.substr(colon + 1)};
}

Result<std::unique_ptr<ControlServer>> ControlServer::start(const std::string& path, std::vector<TimedCommand> schedule, Handler handler) {
  std::unique_ptr<ControlServer> server(new ControlServer);
  if (!path.empty()) {
    auto fd = listen_at(path, 4);
    if (!fd) return fd.status();
    server->listener_ = std::move(*fd);
  }
  server->path_ = path;
  server->schedule_ = std::move(schedule);
  std::stable_sort(server->schedule_.begin(), server->schedule_.end(), [](const auto& a, const auto& b) { return a.at_s < b.at_s; });
  server->handler_ = std::move(handler);
  server->start_ns_ = monotonic_ns();
  server->thread_ = std::thread([raw = server.get()] { raw->run(); });
  return server;
}

ControlServer::~ControlServer() {
  is_stopping_ = true;
  thread_.join();
  if (!path_.empty()) ::unlink(path_.c_str());
}

void ControlServer::run() {
  while (!is_stopping_) {
    pollfd wait{listener_.get(), POLLIN, 0};  // a negative descriptor is ignored
    if (::poll(&wait, 1, kPollMs) > 0) {
      const UniqueFd client(::accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC));
      if (client.is_open()) serve(client.get());
    }
    run_due_commands();
  }
}

void ControlServer::serve(int fd) {
  std::string pending;
  while (!is_stopping_ && pending.size() < kMaxLine) {
    run_due_commands();
    pollfd wait{fd, POLLIN, 0};
    if (::poll(&wait, 1, kPollMs) <= 0) continue;
    char bytes[512];
    const ssize_t size = ::recv(fd, bytes, sizeof bytes, 0);
    if (size <= 0) return;
    pending.append(bytes, static_cast<std::size_t>(size));
    for (std::size_t end = pending.find('\n'); end != std::string::npos; end = pending.find('\n')) {
      const std::string answer = handler_(pending.substr(0, end)) + "\n";
      pending.erase(0, end + 1);
      if (::send(fd, answer.data(), answer.size(), MSG_NOSIGNAL) < 0) return;
    }
  }
}

void ControlServer::run_due_commands() {
  const double now_s = static_cast<double>(monotonic_ns() - start_ns_) * 1e-9;
  while (!schedule_.empty() && schedule_.front().at_s <= now_s) {
    const TimedCommand command = std::move(schedule_.front());
    schedule_.erase(schedule_.begin());
    const std::string answer = handler_(command.line);
    if (answer.starts_with("error"))
      std::fprintf(stderr, "fake-kinect: at %.3f s, '%s': %s\n", command.at_s, command.line.c_str(), answer.c_str());
  }
}

}  // namespace camloc::fakes
