// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// How a program watches the library's work: a progress line on the terminal, Ctrl-C and SIGTERM as the wish to stop.
#pragma once

#include <optional>

#include "core/base/work_observer.h"
#include "tools/common/interrupt.h"
#include "tools/common/progress_line.h"

namespace camloc::tools {

/// Holds an InterruptGuard, so one at a time. The line is cleared when the observer goes: before a result or an error is printed.
class TerminalObserver : public WorkObserver {
 public:
  void show(const std::string& what, std::uint64_t done, std::uint64_t total, const std::string& note) override;
  [[nodiscard]] bool should_stop() const override { return InterruptGuard::is_interrupted(); }

 private:
  InterruptGuard guard_;
  std::optional<ProgressLine> line_;  ///< for what is counted now
  std::string what_;
  std::uint64_t done_ = 0, total_ = 0;
};

}  // namespace camloc::tools
