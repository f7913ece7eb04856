// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A FIFO in the place of a usbfs device file. libusb waits in poll() until the file is writable, which tells that a URB is done. A
// plain file is always writable and keeps the client spinning; a pipe of one page is writable exactly while it is empty.
#pragma once

#include <string>

#include "core/base/result.h"
#include "core/base/unique_fd.h"

namespace camloc::fakes {

/// Not thread-safe.
class ReadyFifo {
 public:
  /// Puts the FIFO in the place of whatever is at `path`. Not writable at first.
  [[nodiscard]] static Result<ReadyFifo> create(const std::string& path);
  /// Makes it writable for those who have it open, or not.
  void set_ready(bool is_ready);

 private:
  UniqueFd fd_;
  bool is_ready_ = true;
};

}  // namespace camloc::fakes
