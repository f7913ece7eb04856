// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Log, clock and counters.
#include "tests/fakes/checks/stream_check.h"

#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>

namespace {
std::atomic<std::uint64_t> num_calls{0};
}  // namespace

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
extern "C" void* __libc_malloc(std::size_t size);
extern "C" void* __libc_calloc(std::size_t count, std::size_t size);
extern "C" void* malloc(std::size_t size) {
  num_calls.fetch_add(1, std::memory_order_relaxed);
  return __libc_malloc(size);
}
extern "C" void* calloc(std::size_t count, std::size_t size) {
  num_calls.fetch_add(1, std::memory_order_relaxed);
  return __libc_calloc(count, size);
}
#endif

namespace camloc::fakes {
namespace {

/// Hashes of the frames of a stream in the fake's log, by stamp.
std::map<std::uint32_t, std::uint64_t> sent_frames(const std::string& log_file, const std::string& stream) {
  std::map<std::uint32_t, std::uint64_t> frames;
  std::ifstream log(log_file);
  std::string line, name, format, hash;
  std::uint64_t index = 0;
  std::uint32_t stamp = 0;
  std::int64_t monotonic_ns = 0;
  int damaged = 0;
  while (std::getline(log, line)) {
    std::istringstream fields(line);
    if (fields >> name >> index >> stamp >> monotonic_ns >> format >> damaged >> hash && name == stream)
      frames[stamp] = std::strtoull(hash.c_str(), nullptr, 16);
  }
  return frames;
}

}  // namespace

std::uint64_t num_allocations() { return num_calls.load(std::memory_order_relaxed); }

double seconds_now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

double cpu_seconds() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) { return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec); };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

bool report_stream(const char* name, const std::vector<ReceivedFrame>& received, const std::string& log_file, double seconds,
                   double min_hz) {
  const auto sent = sent_frames(log_file, name);
  std::uint64_t num_wrong = 0;
  std::size_t num_expected = 0;
  for (const ReceivedFrame& frame : received) {
    const auto found = sent.find(frame.stamp);
    if (found == sent.end() || found->second != frame.hash) ++num_wrong;
  }
  if (!received.empty())
    num_expected = static_cast<std::size_t>(std::count_if(sent.begin(), sent.end(), [&](const auto& frame) {
      const auto since = [&](std::uint32_t stamp) { return stamp - received.front().stamp; };  // the counter wraps
      return since(frame.first) <= since(received.back().stamp);
    }));
  const double hz = static_cast<double>(received.size()) / seconds;
  std::printf("%s: %zu frames, %.2f Hz, %" PRIu64 " wrong, %zu missed\n", name, received.size(), hz, num_wrong,
              num_expected - std::min(num_expected, received.size()));
  return num_wrong == 0 && hz >= min_hz && !received.empty();
}

StreamCost::StreamCost(double seconds) : seconds_(seconds), begin_s_(seconds_now()), begin_cpu_s_(cpu_seconds()) {}

bool StreamCost::goes_on() {
  streamed_s_ = seconds_now() - begin_s_;
  if (warm_s_ == 0 && streamed_s_ > seconds_ / 4) {
    warm_s_ = streamed_s_;
    warm_allocations_ = num_allocations();
  }
  return streamed_s_ < seconds_;
}

void StreamCost::print(const char* driver) {
  std::printf("%s: %.2f s, CPU %.1f %% of a core, %.0f allocations a second\n", driver, streamed_s_,
              100 * (cpu_seconds() - begin_cpu_s_) / streamed_s_,
              static_cast<double>(num_allocations() - warm_allocations_) / std::max(streamed_s_ - warm_s_, 1e-3));
}

}  // namespace camloc::fakes
