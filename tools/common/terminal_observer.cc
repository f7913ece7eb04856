// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/common/terminal_observer.h"

namespace camloc::tools {

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
