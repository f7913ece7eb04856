// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A control socket that says what the test wants.
#pragma once

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <array>
#include <string>
#include <thread>
#include <utility>

#include "core/base/unique_fd.h"

namespace camloc::tools {

/// Answers one connection with a fixed text, after reading one line. An empty answer keeps the client waiting.
class FakeDaemon {
 public:
  FakeDaemon(const std::string& path, std::string answer) : answer_(std::move(answer)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof(address.sun_path) - 1);
    listener_.reset(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
    EXPECT_EQ(::bind(listener_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
    EXPECT_EQ(::listen(listener_.get(), 1), 0);
    thread_ = std::thread([this] { serve(); });
  }
  ~FakeDaemon() { stop(); }
  FakeDaemon(const FakeDaemon&) = delete;
  FakeDaemon& operator=(const FakeDaemon&) = delete;

  /// What the client asked.
  std::string stop() {
    if (thread_.joinable()) thread_.join();
    return request_;
  }

 private:
  void serve() {
    pollfd waiting{listener_.get(), POLLIN, 0};
    if (::poll(&waiting, 1, 5000) != 1) return;
    const UniqueFd client(::accept(listener_.get(), nullptr, nullptr));
    std::array<char, 256> bytes{};
    while (request_.find('\n') == std::string::npos) {
      const ssize_t count = ::recv(client.get(), bytes.data(), bytes.size(), 0);
      if (count <= 0) return;
      request_.append(bytes.data(), static_cast<std::size_t>(count));
    }
    // In two pieces: a stream has no message boundaries.
    const std::size_t half = answer_.size() / 2;
    ::send(client.get(), answer_.data(), half, MSG_NOSIGNAL);
    ::send(client.get(), answer_.data() + half, answer_.size() - half, MSG_NOSIGNAL);
    if (answer_.empty()) ::recv(client.get(), bytes.data(), bytes.size(), 0);
  }

  std::string answer_, request_;
  UniqueFd listener_;
  std::thread thread_;
};

}  // namespace camloc::tools
