// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// An observer that remembers what it was told, and stops the work after so many steps.
#pragma once

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "core/base/work_observer.h"

namespace camloc::testing {

class RecordingObserver : public WorkObserver {
 public:
  explicit RecordingObserver(std::size_t max_steps = std::numeric_limits<std::size_t>::max()) : max_steps_(max_steps) {}

  void show(const std::string& what, std::uint64_t done, std::uint64_t total, const std::string& note) override {
    steps.push_back({what, done, total, note});
  }
  [[nodiscard]] bool should_stop() const override { return steps.size() >= max_steps_; }

  /// How often something was said of this.
  [[nodiscard]] std::size_t count(const std::string& what) const {
    return static_cast<std::size_t>(std::count_if(steps.begin(), steps.end(), [&](const Step& step) { return step.what == what; }));
  }
  /// What is counted goes up by one a step, from one, and not beyond its total.
  [[nodiscard]] bool is_monotone() const {
    for (std::size_t i = 0; i < steps.size(); ++i) {
      const Step& step = steps[i];
      if (step.done == 0 || (step.total > 0 && step.done > step.total)) {
        if (step.done != 0 || step.total != 0) return false;
        continue;
      }
      const bool goes_on = i > 0 && steps[i - 1].what == step.what && steps[i - 1].done < step.done;
      if (step.done != (goes_on ? steps[i - 1].done : 0) + 1) return false;
    }
    return true;
  }

  struct Step {
    std::string what;
    std::uint64_t done = 0, total = 0;
    std::string note;
  };
  std::vector<Step> steps;

 private:
  std::size_t max_steps_;
};

}  // namespace camloc::testing
