// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The loop of the calling thread: take a frame, judge it (image there, later than the last, within the limits), hand it to the
// writers. Every frame that does not reach the disk is counted under the reason.
#include "tools/recording/recorder.h"

#include <chrono>
#include <ctime>
#include <limits>

#include "tools/common/text_format.h"
#include "tools/recording/frame_writers.h"

namespace camloc::tools {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kPoll(100);  // how soon an interruption is noticed

std::int64_t read_clock_ns(clockid_t clock) {
  timespec now{};
  ::clock_gettime(clock, &now);
  return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

/// What to add to CLOCK_MONOTONIC for nanoseconds since the epoch, now: the tightest of a few readings of both clocks.
std::int64_t monotonic_to_epoch_ns() {
  std::int64_t best_width_ns = std::numeric_limits<std::int64_t>::max(), offset_ns = 0;
  for (int i = 0; i < 10; ++i) {
    const std::int64_t before_ns = read_clock_ns(CLOCK_MONOTONIC), epoch_ns = read_clock_ns(CLOCK_REALTIME),
                       after_ns = read_clock_ns(CLOCK_MONOTONIC);
    if (after_ns - before_ns >= best_width_ns) continue;
    best_width_ns = after_ns - before_ns;
    offset_ns = epoch_ns - (before_ns + best_width_ns / 2);
  }
  return offset_ns;
}

/// One recording while it runs.
class Recorder {
 public:
  Recorder(FrameSource* source, RecordingFolder* folder, const RecordingFormat& format, const RecorderOptions& options,
           const RecorderHooks& hooks)
      : source_(*source),
        folder_(*folder),
        format_(format),
        options_(options),
        hooks_(hooks),
        is_live_(source->info().stamp_clock == StampClock::kMonotonic),
        offset_ns_(is_live_ ? monotonic_to_epoch_ns() : 0),
        writers_(folder, options.queue_frames, options.num_writers) {}

  RecordingSummary run() {
    last_frame_ns_ = read_clock_ns(CLOCK_MONOTONIC);
    while (is_going_on()) {
      const Status status = source_.next(&frame_, kPoll);
      if (status) {
        last_frame_ns_ = read_clock_ns(CLOCK_MONOTONIC);
        on_frame();
      } else if (status.code() == ErrorCode::kCorrupt) {
        ++summary_.corrupt;
      } else if (status.code() == ErrorCode::kTimeout) {
        check_silence();
      } else {
        if (status.code() != ErrorCode::kEnd) summary_.end = status;
        break;
      }
    }
    return finish();
  }

 private:
  /// False when a limit is reached, somebody wants an end, or something failed.
  bool is_going_on() {
    if (!summary_.end || hooks_.is_interrupted()) return false;
    if (options_.max_frames && num_taken_ >= *options_.max_frames) return false;
    return !is_time_up_;
  }

  void check_silence() {
    const double silence_s = 1e-9 * static_cast<double>(read_clock_ns(CLOCK_MONOTONIC) - last_frame_ns_);
    if (silence_s < options_.max_silence_s) return;
    summary_.end = {ErrorCode::kTimeout, source_.info().description + ": no frame for " + std::to_string(static_cast<int>(silence_s)) +
                                             " s; check the camera with 'camloc doctor'"};
  }

  void on_frame() {
    if ((format_.is_color ? frame_.color.pixels.empty() : frame_.gray.pixels.empty())) {
      if (num_taken_ > 0 || !format_.is_color) {
        ++summary_.corrupt;
        return;
      }
      summary_.end = {ErrorCode::kInvalid, source_.info().description + ": has no colour; leave out --color"};
      return;
    }
    count_gap();
    const std::int64_t stamp_ns = frame_.stamp_ns + offset_ns_;
    if (stamp_ns < 0 || stamp_ns <= last_stamp_ns_) {
      ++summary_.disordered;
      return;
    }
    if (num_taken_ == 0) {
      first_stamp_ns_ = stamp_ns;
      if (summary_.end = write_camera(); !summary_.end) return;
    }
    const double seconds = 1e-9 * static_cast<double>(stamp_ns - first_stamp_ns_);
    is_time_up_ = options_.max_seconds && seconds >= *options_.max_seconds;
    if (is_time_up_) return;
    summary_.seconds = seconds;
    last_stamp_ns_ = stamp_ns;
    ++num_taken_;
    hand_over(stamp_ns);
  }

  void count_gap() {
    if (is_live_ && last_sequence_ && frame_.sequence > *last_sequence_ + 1) summary_.missed += frame_.sequence - *last_sequence_ - 1;
    last_sequence_ = frame_.sequence;
  }

  Status write_camera() {
    const std::optional<RgbdCamera>& camera = options_.camera ? options_.camera : source_.info().camera;
    if (!camera) return Status::ok();
    const Intrinsics& k = camera->color;
    const int width = format_.is_color ? frame_.color.width : frame_.gray.width;
    const int height = format_.is_color ? frame_.color.height : frame_.gray.height;
    if (k.width != width || k.height != height) {
      return {ErrorCode::kInvalid, text_of("camera '%s' is of %dx%d pixels, the images have %dx%d; give the right --camera",
                                           camera->name.c_str(), k.width, k.height, width, height)};
    }
    summary_.has_camera = true;
    return folder_.write_camera(*camera);
  }

  void hand_over(std::int64_t stamp_ns) {
    const std::optional<Eigen::Vector3d> acceleration = source_.health().acceleration;
    summary_.accelerations += acceleration ? 1 : 0;
    FrameWriters::Totals totals = writers_.totals();
    // A live camera does not wait: its driver would drop frames instead of us, and nobody would count them.
    while (!writers_.push(&frame_, stamp_ns, acceleration, is_live_ ? milliseconds(0) : kPoll)) {
      totals = writers_.totals();
      if (!is_live_ && totals.failure) continue;
      ++(totals.failure ? summary_.dropped : summary_.unwritten);
      break;
    }
    if (!totals.failure) summary_.end = totals.failure;
    const Result<std::uint64_t> free_bytes = hooks_.free_bytes(folder_.path());
    if (free_bytes && *free_bytes < options_.min_free_bytes && summary_.end) {
      summary_.end = {ErrorCode::kIo, folder_.path() + ": only " + std::to_string(*free_bytes >> 20) +
                                          " MiB left on the disk, stopped; free some, or lower --min-free"};
    }
    hooks_.on_progress({totals.frames, totals.bytes, summary_.dropped, totals.queued, free_bytes ? *free_bytes : 0});
  }

  RecordingSummary finish() {
    summary_.unwritten += writers_.finish();
    const FrameWriters::Totals totals = writers_.totals();
    if (summary_.end && !totals.failure) summary_.end = totals.failure;
    summary_.frames = totals.frames;
    summary_.frames_with_depth = totals.frames_with_depth;
    summary_.bytes = totals.bytes;
    summary_.health = source_.health();
    const Status synced = folder_.sync();
    if (summary_.end && !synced) summary_.end = synced;
    return summary_;
  }

  FrameSource& source_;
  RecordingFolder& folder_;
  const RecordingFormat& format_;
  const RecorderOptions& options_;
  const RecorderHooks& hooks_;
  bool is_live_;
  std::int64_t offset_ns_;
  FrameWriters writers_;
  FrameBuffer frame_;
  RecordingSummary summary_;
  std::uint64_t num_taken_ = 0;
  std::optional<std::uint64_t> last_sequence_;
  std::int64_t first_stamp_ns_ = 0, last_stamp_ns_ = -1, last_frame_ns_ = 0;
  bool is_time_up_ = false;
};

}  // namespace

RecordingSummary record(FrameSource* source, RecordingFolder* folder, const RecordingFormat& format, const RecorderOptions& options,
                        const RecorderHooks& hooks) {
  return Recorder(source, folder, format, options, hooks).run();
}

}  // namespace camloc::tools
