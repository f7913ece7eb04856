// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/log.h"

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <span>

#include "core/io/text.h"
#include "daemon/clock.h"
#include "daemon/standard_streams.h"

namespace camloc {
namespace {

constexpr double kBurst = 30;
constexpr double kLinesPerSecond = 5;

/// By the number of a syslog priority.
constexpr std::array kNames = {"emerg", "alert", "crit", "error", "warning", "notice", "info", "debug"};

}  // namespace

Log::Log(LogLevel level, int fd, bool use_priority_prefix)
    : level_(level), fd_(fd), use_priority_prefix_(use_priority_prefix), tokens_(kBurst), refilled_ns_(monotonic_ns()) {}

void Log::write(LogLevel level, const char* format, ...) {
  if (level > level_) return;
  if (!take_token()) {
    ++num_suppressed_;
    return;
  }
  std::array<char, 1024> text{};
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text.data(), text.size(), format, arguments);
  va_end(arguments);
  const std::span<char> line(text.data(), std::strlen(text.data()));
  std::replace_if(
      line.begin(), line.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  make_printable(line);
  if (!say_what_is_missing() || !write_line(level, text.data())) ++num_lost_;
}

// True when nothing is missing, too.
bool Log::say_what_is_missing() {
  std::array<char, 128> text{};
  if (num_suppressed_ > 0) {
    std::snprintf(text.data(), text.size(), "%llu lines held back", static_cast<unsigned long long>(num_suppressed_));
    if (!write_line(LogLevel::kWarning, text.data())) return false;
    num_suppressed_ = 0;
  }
  if (num_lost_ > num_lost_told_) {
    std::snprintf(text.data(), text.size(), "%lld lines lost, nobody took them", static_cast<long long>(num_lost_ - num_lost_told_));
    if (!write_line(LogLevel::kWarning, text.data())) return false;
    num_lost_told_ = num_lost_;
  }
  return true;
}

bool Log::take_token() {
  const std::int64_t now_ns = monotonic_ns();
  tokens_ = std::min(kBurst, tokens_ + kLinesPerSecond * 1e-9 * static_cast<double>(now_ns - refilled_ns_));
  refilled_ns_ = now_ns;
  if (tokens_ < 1) return false;
  tokens_ -= 1;
  return true;
}

bool Log::write_line(LogLevel level, const char* text) {
  std::array<char, 1100> line{};
  const int length = use_priority_prefix_
                         ? std::snprintf(line.data(), line.size(), "<%d>%s\n", static_cast<int>(level), text)
                         : std::snprintf(line.data(), line.size(), "camlocd: %s: %s\n", kNames[static_cast<std::size_t>(level)], text);
  return write_without_waiting(fd_, {line.data(), static_cast<std::size_t>(std::max(length, 0))});
}

}  // namespace camloc
