// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The seam's other side: the kernel.
#include "drivers/v4l2/v4l2_io.h"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <system_error>

#include "drivers/device_clock.h"

namespace camloc {

namespace {

class SystemV4l2Io final : public V4l2Io {
 public:
  [[nodiscard]] int open(const std::string& path) override {
    const int fd = ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
    return fd >= 0 ? fd : -errno;
  }
  void close(int fd) override { ::close(fd); }

  [[nodiscard]] int ioctl(int fd, unsigned long request, void* argument) override {
    while (::ioctl(fd, request, argument) < 0) {
      if (errno != EINTR) return -errno;
    }
    return 0;
  }

  [[nodiscard]] const std::uint8_t* map(int fd, std::size_t length, std::int64_t offset) override {
    // Some drivers refuse mappings that are not writable, too.
    void* bytes = ::mmap(nullptr, length, PROT_READ | PROT_WRITE, MAP_SHARED, fd, offset);
    return bytes == MAP_FAILED ? nullptr : static_cast<const std::uint8_t*>(bytes);
  }
  void unmap(const std::uint8_t* bytes, std::size_t length) override { ::munmap(const_cast<std::uint8_t*>(bytes), length); }

  [[nodiscard]] int poll(pollfd* fds, std::size_t count, int timeout_ms) override {
    const int ready = ::poll(fds, count, timeout_ms);
    if (ready >= 0) return ready;
    return errno == EINTR ? 0 : -errno;
  }

  [[nodiscard]] std::int64_t monotonic_ns() override { return steady_now_ns(); }
};

}  // namespace

std::shared_ptr<V4l2Io> make_system_v4l2_io() { return std::make_shared<SystemV4l2Io>(); }

std::string errno_text(int error) { return std::generic_category().message(std::abs(error)); }

}  // namespace camloc
