// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The service manager's notification protocol (sd_notify(3)): datagrams of NAME=VALUE lines to $NOTIFY_SOCKET. Written out
// here, as that manual page proposes, because libsystemd brings five compression and crypto libraries into the process.
#pragma once

#include <cstdint>
#include <string>

#include "core/base/unique_fd.h"

namespace camloc {

/// Does nothing when the process was not started by a service manager. Never blocks.
class Notifier {
 public:
  /// Reads NOTIFY_SOCKET, WATCHDOG_USEC and WATCHDOG_PID.
  Notifier();

  void ready(const char* status) { send("READY=1\nSTATUS=%s", status); }
  void reloading();
  void stopping() { send("STOPPING=1"); }
  void status(const char* text) { send("STATUS=%s", text); }
  void watchdog() { send("WATCHDOG=1"); }
  /// How often the manager wants to hear watchdog(), 0 = not at all.
  [[nodiscard]] std::int64_t watchdog_ns() const { return watchdog_ns_; }

 private:
  [[gnu::format(printf, 2, 3)]] void send(const char* format, ...);

  UniqueFd socket_;
  std::string address_;  // bytes of a sockaddr_un
  std::int64_t watchdog_ns_ = 0;
};

/// Decides when the watchdog may be fed: only when everything that should move has moved since the last time. A timer
/// alone proves nothing, so a stuck driver or localizer starves the watchdog and the manager restarts the service.
class ProgressWatch {
 public:
  struct Counters {
    std::uint64_t capture_turns = 0;     ///< rounds of the capture thread, also those that end in a time-out
    std::uint64_t frames_captured = 0;   ///< put into the mailbox
    std::uint64_t frames_processed = 0;  ///< published as a pose
    bool is_capture_over = false;        ///< a recording ended: nothing more will move
  };
  /// True when the capture thread turned, and frames were processed if any were waiting.
  [[nodiscard]] bool has_progressed(const Counters& now);

 private:
  Counters last_;
};

}  // namespace camloc
