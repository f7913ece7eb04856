// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Adds up the time of each stage of a frame with a clock that the caller gives; without one it does nothing.
#pragma once

#include <array>
#include <cstdint>

namespace camloc {

enum class Stage : std::uint8_t { kExtract, kCandidates, kMatch, kEstimate, kVerify, kTotal };
inline constexpr int kNumStages = 6;

class StageTimer {
 public:
  using Clock = std::int64_t (*)();
  explicit StageTimer(Clock now_ns) : now_ns_(now_ns) {}

  void start() {
    stage_ns_.fill(0);
    started_ns_ = lap_ns_ = now();
  }
  /// The time since the last call belongs to `stage`.
  void finish(Stage stage) {
    const std::int64_t t = now();
    stage_ns_[static_cast<std::size_t>(stage)] += t - lap_ns_;
    lap_ns_ = t;
  }
  [[nodiscard]] std::array<std::int64_t, kNumStages> stop() {
    stage_ns_[static_cast<std::size_t>(Stage::kTotal)] = now() - started_ns_;
    return stage_ns_;
  }

 private:
  [[nodiscard]] std::int64_t now() const { return now_ns_ == nullptr ? 0 : now_ns_(); }

  Clock now_ns_;
  std::int64_t started_ns_ = 0, lap_ns_ = 0;
  std::array<std::int64_t, kNumStages> stage_ns_{};
};

}  // namespace camloc
