// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The local control socket: a UNIX stream socket whose file permissions (0660) say who may control the daemon. One
// request line, one reply line, then the connection is closed. Everything is non-blocking and bounded: a client that is
// slow, silent or noisy loses its connection, never the daemon's time.
#pragma once

#include <poll.h>

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "core/base/result.h"
#include "core/base/unique_fd.h"
#include "daemon/control_protocol.h"

namespace camloc {

/// Gives the reply line, without its line feed.
using ControlHandler = std::function<std::string(const ControlRequest&)>;

/// Belongs to one thread.
class ControlSocket {
 public:
  static constexpr int kMaxClients = 8;
  static constexpr int kMaxPollFds = kMaxClients + 1;
  static constexpr std::size_t kMaxRequest = 128;              ///< bytes of a line; more is refused
  static constexpr std::int64_t kPatience_ns = 2'000'000'000;  ///< for a client to say all and read all
  static constexpr std::int64_t kCrowded_ns = 100'000'000;     ///< the same while others wait for a place

  /// Owns `path` from now on, guarded by a lock on "path.lock", so that two daemons starting at once cannot both win. A
  /// socket file that nobody listens on is replaced. Errors: kUnavailable (another daemon runs), kInvalid (the path is
  /// something else, or too long), kIo.
  static Result<std::unique_ptr<ControlSocket>> open(const std::string& path);
  /// Removes the socket file.
  ~ControlSocket();

  /// Fills in what to wait for; the number of entries used. `fds` must hold kMaxPollFds.
  [[nodiscard]] int prepare_poll(std::span<pollfd> fds);
  /// Accepts, reads, answers and writes whatever the entries of prepare_poll() became ready for.
  void handle(std::span<const pollfd> fds, std::int64_t now_ns, const ControlHandler& handler);
  /// Drops the clients that took too long; where others wait for a place, those that said nothing within a tenth of a second.
  void expire(std::int64_t now_ns);

 private:
  struct Client {
    UniqueFd fd;
    std::array<char, kMaxRequest> request{};
    std::size_t num_read = 0;
    std::string reply;  // empty until the request is complete
    std::size_t num_written = 0;
    std::int64_t deadline_ns = 0;
    bool is_overdue = false;  // expire() has seen that once
  };

  ControlSocket(std::string path, UniqueFd lock, UniqueFd listener);
  void accept_clients(std::int64_t now_ns);
  [[nodiscard]] bool is_somebody_waiting() const;
  [[nodiscard]] bool read_request(Client& client, const ControlHandler& handler);
  void write_reply(Client& client);
  static void close_client(Client& client);

  std::string path_;
  UniqueFd lock_, listener_;
  bool is_resting_ = false;  // no descriptor was left for a client: not before the next expire()
  std::array<Client, kMaxClients> clients_;
};

}  // namespace camloc
