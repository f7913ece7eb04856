// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Log lines on stderr. Under systemd each carries its priority as "<6>" so that journald can sort them; elsewhere the
// level is spelled out. The daemon logs changes of state, not frames, and a token bucket holds back what would flood. Lines
// that nobody reads are lost and counted; the daemon never waits for a reader.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <string>

namespace camloc {

/// Values are syslog priorities.
enum class LogLevel : std::uint8_t { kError = 3, kWarning = 4, kInfo = 6, kDebug = 7 };

/// Belongs to one thread. Allocates nothing: longer lines are cut at 1023 bytes, line breaks become spaces, what drives a terminal '?'.
class Log {
 public:
  explicit Log(LogLevel level, int fd = 2, bool use_priority_prefix = std::getenv("JOURNAL_STREAM") != nullptr);

  void set_level(LogLevel level) { level_ = level; }
  [[gnu::format(printf, 3, 4)]] void write(LogLevel level, const char* format, ...);
  /// Lines that could not be written so far (pipe full or closed, disk full); the next line that can be says how many there were.
  [[nodiscard]] std::int64_t num_lost() const { return num_lost_; }

 private:
  bool take_token();
  [[nodiscard]] bool say_what_is_missing();
  [[nodiscard]] bool write_line(LogLevel level, const char* text);

  LogLevel level_;
  int fd_;
  bool use_priority_prefix_;
  double tokens_;
  std::int64_t refilled_ns_;
  std::uint64_t num_suppressed_ = 0;
  std::int64_t num_lost_ = 0, num_lost_told_ = 0;
};

/// Lets a repeated complaint (a retry every second) through once, and again when it changes.
class RepeatFilter {
 public:
  [[nodiscard]] bool is_new(const std::string& text) {
    if (text == last_) return false;
    last_ = text;
    return true;
  }
  void clear() { last_.clear(); }
  [[nodiscard]] const std::string& last() const { return last_; }

 private:
  std::string last_;
};

}  // namespace camloc
