// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The thread that owns the frame source: opens it, fills the mailbox, opens it again when the device went away. It never
// logs and never decides what a failure means; it reports, the main thread acts.
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
#include "daemon/frame_mailbox.h"
#include "drivers/frame_source.h"

namespace camloc {

struct CaptureOptions {
  std::string url;
  bool wait_for_reader = false;                ///< hold a frame back until the last one was taken, instead of dropping
  std::chrono::milliseconds retry{1000};       ///< pause before the source is opened again
  std::chrono::milliseconds frame_timeout{100};  ///< given to FrameSource::next(); bounds the time to stop
};

using OpenSource = std::function<Result<std::unique_ptr<FrameSource>>(const std::string& url)>;

enum class CapturePhase : std::uint8_t {
  kOpening,      ///< first attempt, or just after a failure
  kStreaming,    ///< open; frames may still be late
  kUnavailable,  ///< opening failed or the device went away; tried again
  kEnded,        ///< the recording is over; nothing more will come
};

struct CaptureReport {
  CapturePhase phase = CapturePhase::kOpening;
  bool was_open = false;
  FrameSourceInfo info;  ///< of the source when it was last opened
  std::string problem;   ///< one line while kUnavailable
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

  [[nodiscard]] std::uint64_t num_turns() const { return shared_->num_turns.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t num_received() const { return shared_->num_received.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t num_corrupt() const { return shared_->num_corrupt.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t num_restarts() const { return shared_->num_restarts.load(std::memory_order_relaxed); }

 private:
  /// Owned by both threads, so that an abandoned one never touches freed memory.
  struct Shared {
    CaptureOptions options;
    OpenSource open_source;
    int wake_fd = -1;
    FrameMailbox mailbox;
    std::atomic<bool> should_stop{false};
    std::atomic<std::uint64_t> report_number{0}, num_turns{0}, num_received{0}, num_corrupt{0}, num_restarts{0};

    std::mutex mutex;  // the rest
    std::condition_variable changed;
    CaptureReport report;
    bool is_finished = false;

    void run();
    [[nodiscard]] Status stream(FrameSource& source);
    void wait_for_reader();
    void set_report(CapturePhase phase, const FrameSourceInfo* info, const std::string& problem);
    void pause();
    void wake() const;
  };

  std::shared_ptr<Shared> shared_;
  std::thread thread_;
};

}  // namespace camloc
