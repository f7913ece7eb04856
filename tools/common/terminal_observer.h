// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// How a program watches a long job: a line on stderr that is written over and over, Ctrl-C and SIGTERM as the wish to stop, and
// both together as the observer of the library's work.
#pragma once

#include <chrono>
#include <csignal>
#include <cstdint>
#include <optional>
#include <string>

#include "core/base/work_observer.h"

namespace camloc::tools {

/// While it lives the first SIGINT or SIGTERM sets a flag, which ends a job between two frames; a second one ends the program at
/// once. One at a time.
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

/// Silent when stderr is no terminal.
class ProgressLine {
 public:
  /// `num_steps` 0: not known beforehand, so there is no bar. `unit` is what is counted.
  explicit ProgressLine(std::uint64_t num_steps, std::string unit = "frame");
  /// Clears the line.
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// "[####....] frame 12/300  NOTE  8 s left"; at most ten times a second, and after the last step.
  void show(std::uint64_t step, const std::string& note = "");
  /// Replaces the bar by a text.
  void say(const std::string& text) const;

 private:
  bool is_terminal_;
  std::uint64_t num_steps_;
  std::string unit_;
  std::chrono::steady_clock::time_point start_, last_shown_;
};

/// What show() prints, for `elapsed_s` since the start.
[[nodiscard]] std::string format_progress(std::uint64_t step, std::uint64_t num_steps, const std::string& unit, const std::string& note,
                                          double elapsed_s);

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
