// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Ctrl-C and SIGTERM end a long job between two frames instead of in the middle of one.
#pragma once

#include <csignal>

namespace camloc::tools {

/// While it lives the first SIGINT or SIGTERM sets a flag; a second one ends the program at once. One at a time.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;
  [[nodiscard]] static bool is_interrupted();

 private:
  struct sigaction old_interrupt_ = {}, old_terminate_ = {};
};

}  // namespace camloc::tools
