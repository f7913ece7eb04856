// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/fakes/ready_fifo.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace camloc::fakes {

Result<ReadyFifo> ReadyFifo::create(const std::string& path) {
  constexpr int kOnePage = 4096;
  const auto failed = [&] { return Status(ErrorCode::kIo, path + ": no FIFO: " + std::strerror(errno)); };
  ::unlink(path.c_str());
  if (::mkfifo(path.c_str(), 0600) != 0) return failed();
  ReadyFifo fifo;
  fifo.fd_.reset(::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC));
  if (!fifo.fd_.is_open() || ::fcntl(fifo.fd_.get(), F_SETPIPE_SZ, kOnePage) < 0) return failed();
  fifo.set_ready(false);
  return fifo;
}

void ReadyFifo::set_ready(bool is_ready) {
  if (is_ready == is_ready_) return;
  is_ready_ = is_ready;
  char byte = 0;
  const ssize_t moved = is_ready ? ::read(fd_.get(), &byte, 1) : ::write(fd_.get(), &byte, 1);
  static_cast<void>(moved);  // neither blocks nor fails: the pipe holds a byte exactly when it is not ready
}

}  // namespace camloc::fakes
