// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The system calls of V4L2, as a seam: a test puts a device of its own behind them (Linux kernel documentation, "Video for
// Linux API", part I). Nothing that comes back through here is to be believed before it was checked.
#pragma once

#include <poll.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>

namespace camloc {

/// Errors come back as negative errno values. No call blocks, except poll() for as long as it is told to.
class V4l2Io {
 public:
  virtual ~V4l2Io() = default;
  /// A descriptor to read and write without blocking.
  [[nodiscard]] virtual int open(const std::string& path) = 0;
  virtual void close(int fd) = 0;
  /// An interrupted call is made again.
  [[nodiscard]] virtual int ioctl(int fd, unsigned long request, void* argument) = 0;
  /// `length` bytes at `offset`, to be read; nullptr where the device refuses.
  [[nodiscard]] virtual const std::uint8_t* map(int fd, std::size_t length, std::int64_t offset) = 0;
  virtual void unmap(const std::uint8_t* bytes, std::size_t length) = 0;
  /// As poll(2); 0 when interrupted.
  [[nodiscard]] virtual int poll(pollfd* fds, std::size_t count, int timeout_ms) = 0;
  /// CLOCK_MONOTONIC, nanoseconds.
  [[nodiscard]] virtual std::int64_t monotonic_ns() = 0;
};

/// The kernel's.
[[nodiscard]] std::shared_ptr<V4l2Io> make_system_v4l2_io();

/// "Permission denied" for -EACCES or EACCES.
[[nodiscard]] std::string errno_text(int error);

/// Owner of a descriptor of a V4l2Io, which outlives it.
class V4l2Fd {
 public:
  V4l2Fd(V4l2Io& io, int fd) : io_(&io), fd_(fd) {}
  ~V4l2Fd() {
    if (fd_ >= 0) io_->close(fd_);
  }
  V4l2Fd(V4l2Fd&& other) noexcept : io_(other.io_), fd_(std::exchange(other.fd_, -1)) {}

  [[nodiscard]] int get() const { return fd_; }
  [[nodiscard]] V4l2Io& io() const { return *io_; }

 private:
  V4l2Io* io_;
  int fd_;
};

}  // namespace camloc
