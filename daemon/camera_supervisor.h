// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Decides what to do about a camera that is there but delivers nothing: first the gentle means, then the rough ones. It
// knows no device and no clock: the capture thread tells it what happens and when, and does what it says.
//
//   a frame is overdue > restart the stream > open the device again > reset it on its bus > open again > reset > ...
//
// Each step is given time to show a frame before the next; from the first reset on that time doubles, up to a limit, so
// that a broken camera is neither forgotten nor hammered.
#pragma once

#include <cstdint>

namespace camloc {

enum class RecoveryStep : std::uint8_t {
  kNone,           ///< all is well, or the last step still has time
  kRestartStream,  ///< FrameSource::restart()
  kReopen,         ///< close the source and open it again at once
  kResetDevice,    ///< FrameSource::reset_device(), then as kReopen
};

struct SupervisorOptions {
  std::int64_t stall_ns = 250'000'000;          ///< a streaming camera without a frame for this long has stalled
  std::int64_t first_frame_ns = 1'500'000'000;  ///< how long a stream may take to its first frame
  std::int64_t corrupt_ns = 5'000'000'000;      ///< how long nothing but corrupt frames is accepted
  std::int64_t longest_patience_ns = 20'000'000'000;
};

/// Belongs to one thread. Times are of one monotonic clock, nanoseconds.
class CameraSupervisor {
 public:
  explicit CameraSupervisor(const SupervisorOptions& options) : options_(options) {}

  /// The source is open. Recordings keep their own pace (`is_live` false) and are left alone.
  void on_opened(std::int64_t now_ns, bool is_live);
  /// A frame arrived. True when it ended a stall.
  bool on_frame(std::int64_t now_ns);

  /// A frame arrived, but with parts missing: the camera is alive, the way from it is bad. Only when nothing else comes for
  /// long is that treated as a stall.
  void on_corrupt_frame(std::int64_t now_ns);

  /// The step that is due; it counts as taken. Ask after every next() that brought no frame.
  [[nodiscard]] RecoveryStep take_due_step(std::int64_t now_ns);
  /// The step could not be taken: the next one is due at once.
  void on_step_failed(std::int64_t now_ns) { deadline_ns_ = now_ns; }
  /// How long next() may wait before take_due_step() has something to say; very long for recordings.
  [[nodiscard]] std::int64_t time_left_ns(std::int64_t now_ns) const;

  /// From the moment a frame was overdue until one arrives.
  [[nodiscard]] bool is_stalled() const { return is_stalled_; }
  /// Of the last stall that ended: from its last good frame to the next one.
  [[nodiscard]] std::int64_t last_recovery_ns() const { return last_recovery_ns_; }

 private:
  SupervisorOptions options_;
  bool is_live_ = false;
  bool is_stalled_ = false;
  RecoveryStep last_step_ = RecoveryStep::kNone;
  std::int64_t patience_ns_ = 0;    // for the next step, once resets have begun
  std::int64_t deadline_ns_ = 0;    // of the next frame
  std::int64_t last_frame_ns_ = 0;  // or the time it was opened, before the first
  std::int64_t last_recovery_ns_ = 0;
};

}  // namespace camloc
