// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Recorded frames at their recorded times: what the sources of recordings have in common, whatever their files are.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/io/sequence.h"
#include "drivers/frame_source.h"
#include "drivers/source_url.h"

namespace camloc {

/// Releases frames when they are due. Deadlines are absolute, so that a late frame does not delay the ones after it.
/// Not thread-safe. With speed 0 nothing ever waits.
class Pacer {
 public:
  explicit Pacer(double speed) : speed_(speed) {}

  /// Waits until `stamp_ns` is due, at most `timeout`; false: not due yet. The first stamp asked for is due at once.
  [[nodiscard]] bool wait_for(std::int64_t stamp_ns, std::chrono::milliseconds timeout) {
    if (speed_ <= 0) return true;
    const Clock::time_point now = Clock::now();
    if (!is_started_) {
      is_started_ = true;
      start_ = now;
      first_stamp_ns_ = stamp_ns;
    }
    const double offset_ns = static_cast<double>(stamp_ns - first_stamp_ns_) / speed_;
    const Clock::time_point due = start_ + std::chrono::nanoseconds(static_cast<std::int64_t>(offset_ns));
    const Clock::time_point until = std::min(due, now + timeout);
    if (until > now) std::this_thread::sleep_until(until);
    return due <= until;
  }

 private:
  using Clock = std::chrono::steady_clock;
  double speed_;
  bool is_started_ = false;
  Clock::time_point start_;
  std::int64_t first_stamp_ns_ = 0;
};

/// What a URL asks for.
struct PlaybackOptions {
  double speed = 0;  ///< times the recorded rate; 0 = as fast as possible
  bool loop = false;
  bool wants_color = false;
};

/// The indices that "frames" and "exclude" of the URL leave. kInvalid: malformed, or none is left.
[[nodiscard]] inline Result<std::vector<std::size_t>> chosen_frames(const SourceUrl& url, std::size_t num_recorded) {
  Result<std::vector<std::size_t>> chosen = select_frames(url.text_option("frames", ""), url.text_option("exclude", ""), num_recorded);
  if (!chosen) return chosen.status().with_context(url.path);
  if (!chosen->empty()) return chosen;
  return Status(ErrorCode::kInvalid, url.text + ": the selection leaves none of " + std::to_string(num_recorded) + " frames");
}

/// From the first exposure to one mean interval after the last; `single_ns` for a recording of one frame.
[[nodiscard]] inline std::int64_t playback_length_ns(std::int64_t span_ns, std::size_t num_frames, std::int64_t single_ns) {
  return num_frames > 1 ? span_ns + span_ns / static_cast<std::int64_t>(num_frames - 1) : single_ns;
}

/// Plays the chosen frames once or in rounds. A frame is decoded before its time has come and then released on time, so that
/// decoding does not delay it.
class Playback : public FrameSource {
 public:
  [[nodiscard]] const FrameSourceInfo& info() const final { return info_; }

  [[nodiscard]] Status next(FrameBuffer* frame, std::chrono::milliseconds timeout) final {
    if (position_ == *info_.num_frames) {
      if (!options_.loop) return {ErrorCode::kEnd, prefix_ + "the recording is over"};
      position_ = 0;
      ++round_;
    }
    if (!is_loaded_) {
      load_status_ = load(position_, round_);
      if (load_status_.code() == ErrorCode::kUnavailable) return load_status_;
      is_loaded_ = true;
    }
    if (!pacer_.wait_for(loaded_.stamp_ns, timeout)) return {ErrorCode::kTimeout, prefix_ + "the next frame is not due yet"};
    is_loaded_ = false;
    ++position_;
    if (load_status_) std::swap(*frame, loaded_);
    return load_status_;
  }

 protected:
  /// `info` knows num_frames; `prefix` stands before the messages.
  Playback(FrameSourceInfo info, const PlaybackOptions& options, std::string prefix)
      : info_(std::move(info)), options_(options), prefix_(std::move(prefix)), pacer_(options.speed) {}
  /// Decodes a chosen frame into `loaded_`, with the stamp of that round even where it fails.
  [[nodiscard]] virtual Status load(std::size_t position, std::uint64_t round) = 0;

  [[nodiscard]] static Status check_size(int width, int height, int expected_width, int expected_height) {
    if (width == expected_width && height == expected_height) return Status::ok();
    return {ErrorCode::kCorrupt, std::to_string(width) + "x" + std::to_string(height) + " pixels, the recording has " +
                                     std::to_string(expected_width) + "x" + std::to_string(expected_height)};
  }

  FrameSourceInfo info_;
  PlaybackOptions options_;
  FrameBuffer loaded_;  // decoded, waiting for its time

 private:
  std::string prefix_;
  Pacer pacer_;
  Status load_status_;
  bool is_loaded_ = false;
  std::size_t position_ = 0;
  std::uint64_t round_ = 0;
};

}  // namespace camloc
