// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The thread that owns the frame source: opens it, fills the mailbox, does what the supervisor says when a camera falls
// silent, opens it again when the device went away. It never logs; it reports and counts, the main thread tells people.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "core/base/result.h"
#include "daemon/camera_supervisor.h"
#include "daemon/frame_mailbox.h"
#include "drivers/frame_source.h"

namespace camloc {

struct CaptureOptions {
  std::string url;
  bool wait_for_reader = false;           ///< hold a frame back until the last one was taken, instead of dropping
  std::chrono::milliseconds retry{1000};  ///< pause before the source is opened again
  SupervisorOptions supervisor;
};

using OpenSource = std::function<Result<std::unique_ptr<FrameSource>>(const std::string& url)>;

enum class CapturePhase : std::uint8_t {
  kOpening,      ///< first attempt, or just after a failure
  kStreaming,    ///< open; the first frame may still be to come
  kStalled,      ///< open, but frames are overdue; being recovered
  kUnavailable,  ///< opening failed or the device went away; tried again
  kEnded,        ///< the recording is over; nothing more will come
};

/// One word for status messages, at most 15 letters: opening, streaming, stalled, missing, ended.
[[nodiscard]] const char* to_string(CapturePhase phase);

struct CaptureReport {
  CapturePhase phase = CapturePhase::kOpening;
  bool was_open = false;
  FrameSourceInfo info;  ///< of the source when it was last opened
  std::string problem;   ///< one line while kStalled or kUnavailable
};

/// What the thread has seen and done since it started.
struct CaptureCounts {
  std::uint64_t turns = 0;  ///< rounds of its loop, also those that end in a time-out
  std::uint64_t frames_received = 0, frames_corrupt = 0;
  std::uint64_t stalls = 0;  ///< times a frame was overdue
  std::uint64_t stream_restarts = 0;
  std::uint64_t device_reopens = 0;  ///< opened anew after it had been open
  std::uint64_t device_resets = 0;
  std::int64_t last_recovery_ns = 0;  ///< of the last stall or absence: from the last frame before it to the first after
  FrameSourceHealth source;           ///< as of a fraction of a second ago
};

class CaptureThread {
 public:
  /// Starts the thread. It writes to the eventfd `wake_fd` after every frame and every new report.
  CaptureThread(const CaptureOptions& options, OpenSource open_source, int wake_fd);
  /// Stops, and waits for as long as it takes.
  ~CaptureThread();

  /// False when the source did not come back within `patience`: the thread is then left to itself, its memory with it,
  /// and the process should end with _exit().
  [[nodiscard]] bool stop(std::chrono::milliseconds patience);

  [[nodiscard]] FrameMailbox& mailbox() { return shared_->mailbox; }
  /// Grows with every change of report(); cheap enough to ask for every frame.
  [[nodiscard]] std::uint64_t report_number() const { return shared_->report_number.load(std::memory_order_acquire); }
  [[nodiscard]] CaptureReport report() const;

  /// Cheap enough to ask for every frame.
  [[nodiscard]] CaptureCounts counts() const;

 private:
  /// Owned by both threads, so that an abandoned one never touches freed memory.
  struct Shared {
    CaptureOptions options;
    OpenSource open_source;
    int wake_fd = -1;
    FrameMailbox mailbox;
    std::atomic<bool> should_stop{false};
    std::atomic<std::uint64_t> report_number{0};

    // The thread's own.
    CameraSupervisor supervisor{SupervisorOptions{}};
    std::int64_t last_frame_ns = 0;  // 0 before the first
    bool was_away = false;           // the device vanished since then
    std::int64_t health_read_ns = 0;

    std::mutex mutex;  // the rest
    std::condition_variable changed;
    CaptureReport report;
    CaptureCounts counts;
    bool is_finished = false;

    void run();
    [[nodiscard]] Status stream(FrameSource& source);
    [[nodiscard]] Result<std::unique_ptr<FrameSource>> open_within_memory() const;
    [[nodiscard]] Status next_frame(FrameSource& source, CapturedFrame* frame);
    void on_frame(FrameSource& source, CapturedFrame* frame);
    [[nodiscard]] Status take_step(FrameSource& source, RecoveryStep step);
    void count(std::uint64_t CaptureCounts::*counter);
    void set_recovery(std::int64_t duration_ns);
    void read_health(FrameSource& source, std::int64_t now_ns);
    void wait_for_reader();
    void set_report(CapturePhase phase, const FrameSourceInfo* info, const std::string& problem);
    void pause();
    void wake() const;
  };

  std::shared_ptr<Shared> shared_;
  std::thread thread_;
};

}  // namespace camloc
