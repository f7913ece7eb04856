// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/sd_notify.h"

#include <sys/socket.h>
#include <sys/un.h>

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "core/io/text.h"
#include "daemon/clock.h"

namespace camloc {
namespace {

std::int64_t environment_number(const char* name) {
  const char* text = std::getenv(name);
  return text == nullptr ? 0 : parse_int(text).value_or(0);
}

}  // namespace

Notifier::Notifier() {
  const char* path = std::getenv("NOTIFY_SOCKET");
  if (path == nullptr || (path[0] != '/' && path[0] != '@')) return;
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::size_t length = std::strlen(path);
  if (length >= sizeof(address.sun_path)) return;
  std::memcpy(address.sun_path, path, length);
  if (path[0] == '@') address.sun_path[0] = '\0';
  const char* bytes = reinterpret_cast<const char*>(&address);
  address_.assign(bytes, offsetof(sockaddr_un, sun_path) + length);
  socket_.reset(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));

  const std::int64_t pid = environment_number("WATCHDOG_PID");
  if (pid == 0 || pid == getpid()) watchdog_ns_ = std::max<std::int64_t>(environment_number("WATCHDOG_USEC"), 0) * 1000;
}

void Notifier::reloading() { send("RELOADING=1\nMONOTONIC_USEC=%lld", static_cast<long long>(monotonic_ns() / 1000)); }

void Notifier::send(const char* format, ...) {
  if (!socket_.is_open()) return;
  std::array<char, 600> text{};
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text.data(), text.size(), format, arguments);
  va_end(arguments);
  ::sendto(socket_.get(), text.data(), std::strlen(text.data()), MSG_NOSIGNAL, reinterpret_cast<const sockaddr*>(address_.data()),
           static_cast<socklen_t>(address_.size()));
}

bool ProgressWatch::has_progressed(const Counters& now) {
  const bool capture_moved = now.is_capture_over || now.capture_turns != last_.capture_turns;
  // Frames that arrived must come out again; dropped ones count as long as newer ones are processed.
  const bool has_work = now.frames_captured != last_.frames_captured;
  const bool work_moved = !has_work || now.frames_processed != last_.frames_processed;
  if (!capture_moved || !work_moved) return false;
  last_ = now;
  return true;
}

}  // namespace camloc
