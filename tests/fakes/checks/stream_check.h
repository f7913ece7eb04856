// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What the programs that check a driver on the fake Kinect share: frames as received against the fake's log of those sent, and what
// they cost in CPU time and allocations. The allocation counter replaces malloc in the whole program, C libraries included.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace camloc::fakes {

/// Calls of malloc and calloc so far; stays 0 under sanitizers.
[[nodiscard]] std::uint64_t num_allocations();
[[nodiscard]] double seconds_now();
/// Of this process.
[[nodiscard]] double cpu_seconds();

/// XXH3 of the bytes as the device sent them, and the stamp of its clock.
struct ReceivedFrame {
  std::uint32_t stamp = 0;
  std::uint64_t hash = 0;
};

/// Counts from a quarter of the run on, when every buffer is there.
class StreamCost {
 public:
  explicit StreamCost(double seconds);
  /// True until the time is over.
  [[nodiscard]] bool goes_on();
  void print(const char* driver);
  [[nodiscard]] double streamed_s() const { return streamed_s_; }

 private:
  double seconds_, begin_s_, begin_cpu_s_;
  double warm_s_ = 0, streamed_s_ = 0;
  std::uint64_t warm_allocations_ = 0;
};

/// Prints how the received frames of a stream ("video", "depth") compare with those of the log; whether all were right and there
/// were `min_hz` of them at least.
[[nodiscard]] bool report_stream(const char* name, const std::vector<ReceivedFrame>& received, const std::string& log_file, double seconds,
                                 double min_hz);

}  // namespace camloc::fakes
