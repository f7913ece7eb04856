// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Who watches a long job: a terminal, a test, or nobody. The job says how far it is and asks whether it shall go on; it neither
// prints nor looks at signals.
#pragma once

#include <cstdint>
#include <string>

namespace camloc {

/// Called by the thread that does the work. The base class is nobody: it sees nothing and stops nothing.
class WorkObserver {
 public:
  virtual ~WorkObserver() = default;

  /// `done` of `total` (0: not known beforehand) are done of what `what` counts, with a note on it; both 0: `what` is a stage
  /// that begins and is not counted. `done` falls only where the counting begins anew.
  virtual void show(const std::string& what, std::uint64_t done, std::uint64_t total, const std::string& note) {
    static_cast<void>(what), static_cast<void>(done), static_cast<void>(total), static_cast<void>(note);
  }
  /// The work shall end here, with what is whole so far; asked between two steps.
  [[nodiscard]] virtual bool should_stop() const { return false; }

  /// Both in one: false ends the work.
  [[nodiscard]] bool on_progress(const std::string& what, std::uint64_t done = 0, std::uint64_t total = 0, const std::string& note = {}) {
    show(what, done, total, note);
    return !should_stop();
  }
  [[nodiscard]] static WorkObserver& nobody() {
    static WorkObserver observer;  // has no state
    return observer;
  }
};

}  // namespace camloc
