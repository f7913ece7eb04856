// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The only place of the daemon that reads clocks; core is handed monotonic_ns where it measures.
#pragma once

#include <time.h>

#include <cstdint>

namespace camloc {

inline std::int64_t read_clock_ns(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<std::int64_t>(now.tv_sec) * 1'000'000'000 + now.tv_nsec;
}

/// For intervals; never jumps.
inline std::int64_t monotonic_ns() { return read_clock_ns(CLOCK_MONOTONIC); }
/// Since the epoch; for stamps that leave this process.
inline std::int64_t realtime_ns() { return read_clock_ns(CLOCK_REALTIME); }

}  // namespace camloc
