// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A line on stderr that is written over and over while a long job runs; silent when stderr is no terminal.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace camloc::tools {

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

}  // namespace camloc::tools
