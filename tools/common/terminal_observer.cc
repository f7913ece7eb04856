// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/common/terminal_observer.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "tools/common/text_format.h"

namespace camloc::tools {
namespace {

constexpr int kBarWidth = 24;

volatile std::sig_atomic_t interrupted = 0;  // a signal handler reaches nothing but file scope

void on_interrupt(int) { interrupted = 1; }

}  // namespace

InterruptGuard::InterruptGuard() {
  interrupted = 0;
  struct sigaction action = {};
  action.sa_handler = on_interrupt;
  action.sa_flags = static_cast<int>(SA_RESETHAND);  // a second Ctrl-C ends the program at once
  sigaction(SIGINT, &action, &old_interrupt_);
  sigaction(SIGTERM, &action, &old_terminate_);
}

InterruptGuard::~InterruptGuard() {
  sigaction(SIGINT, &old_interrupt_, nullptr);
  sigaction(SIGTERM, &old_terminate_, nullptr);
}

bool InterruptGuard::is_interrupted() { return interrupted != 0; }

std::string format_progress(std::uint64_t step, std::uint64_t num_steps, const std::string& unit, const std::string& note,
                            double elapsed_s) {
  const std::string spaced_note = note.empty() ? "" : "  " + note;
  if (num_steps == 0) return unit + " " + std::to_string(step) + spaced_note;
  const double done = std::min(1.0, static_cast<double>(step) / static_cast<double>(num_steps));
  const auto filled = static_cast<std::size_t>(done * kBarWidth);
  char left[32] = "";
  if (step > 0) std::snprintf(left, sizeof left, "  %.0f s left", elapsed_s * (1 - done) / done);
  return "[" + std::string(filled, '#') + std::string(kBarWidth - filled, '.') + "] " + unit + " " + std::to_string(step) + "/" +
         std::to_string(num_steps) + spaced_note + left;
}

ProgressLine::ProgressLine(std::uint64_t num_steps, std::string unit)
    : is_terminal_(isatty(STDERR_FILENO) == 1), num_steps_(num_steps), unit_(std::move(unit)), start_(std::chrono::steady_clock::now()) {}

ProgressLine::~ProgressLine() { say(""); }

void ProgressLine::show(std::uint64_t step, const std::string& note) {
  const auto now = std::chrono::steady_clock::now();
  if (!is_terminal_ || (step != num_steps_ && now - last_shown_ < std::chrono::milliseconds(100))) return;
  last_shown_ = now;
  say(format_progress(step, num_steps_, unit_, note, std::chrono::duration<double>(now - start_).count()));
}

void ProgressLine::say(const std::string& text) const {
  if (!is_terminal_) return;
  std::fprintf(stderr, "\r\033[K%s", printable(text).c_str());
  std::fflush(stderr);
}

void TerminalObserver::show(const std::string& what, std::uint64_t done, std::uint64_t total, const std::string& note) {
  // The time that is left is reckoned from where the counting began.
  if (!line_ || what != what_ || total != total_ || done < done_) line_.emplace(total, what);
  what_ = what;
  total_ = total;
  done_ = done;
  if (done == 0 && total == 0)
    line_->say(what);
  else
    line_->show(done, note);
}

}  // namespace camloc::tools
