// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture_thread.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <exception>
#include <utility>

#include "daemon/clock.h"

namespace camloc {
namespace {

constexpr std::int64_t kHealthPeriod_ns = 200'000'000;
constexpr std::int64_t kFrameTimeout_ms = 100;  // given to FrameSource::next() at most; bounds the time to stop

std::string overdue_text(std::int64_t silence_ns, const char* step) {
  return "no frame for " + std::to_string(silence_ns / 1'000'000) + " ms, " + step;
}

}  // namespace

const char* to_string(CapturePhase phase) {
  constexpr std::array kNames = {"opening", "streaming", "stalled", "missing", "ended"};
  return kNames[static_cast<std::size_t>(phase)];
}

CaptureThread::CaptureThread(const CaptureOptions& options, OpenSource open_source, int wake_fd) : shared_(std::make_shared<Shared>()) {
  shared_->options = options;
  shared_->open_source = std::move(open_source);
  shared_->wake_fd = wake_fd;
  shared_->supervisor = CameraSupervisor(options.supervisor);
  thread_ = std::thread([shared = shared_] { shared->run(); });
}

CaptureThread::~CaptureThread() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(shared_->mutex);
    shared_->should_stop = true;
  }
  shared_->changed.notify_all();
  thread_.join();
}

bool CaptureThread::stop(std::chrono::milliseconds patience) {
  if (!thread_.joinable()) return true;
  std::unique_lock lock(shared_->mutex);
  shared_->should_stop = true;
  shared_->changed.notify_all();
  const bool is_finished = shared_->changed.wait_for(lock, patience, [this] { return shared_->is_finished; });
  lock.unlock();
  if (is_finished) {
    thread_.join();
  } else {
    thread_.detach();
  }
  return is_finished;
}

CaptureReport CaptureThread::report() const {
  const std::lock_guard lock(shared_->mutex);
  return shared_->report;
}

CaptureCounts CaptureThread::counts() const {
  const std::lock_guard lock(shared_->mutex);
  return shared_->counts;
}

void CaptureThread::Shared::run() {
  bool was_open = false;
  while (!should_stop) {
    count(&CaptureCounts::turns);
    Result<std::unique_ptr<FrameSource>> source = open_within_memory();
    Status status = source.status();
    if (source) {
      if (was_open) count(&CaptureCounts::device_reopens);
      was_open = true;
      supervisor.on_opened(monotonic_ns(), (*source)->info().stamp_clock == StampClock::kMonotonic);
      const bool is_stalled = supervisor.is_stalled();
      set_report(is_stalled ? CapturePhase::kStalled : CapturePhase::kStreaming, &(*source)->info(),
                 is_stalled ? "open again, no frame yet" : "");
      status = stream(**source);
      source.value().reset();  // give the device back before pausing
    }
    if (should_stop) break;
    if (status.is_ok()) continue;  // a step of recovery: open again at once
    if (status.code() == ErrorCode::kEnd) {
      set_report(CapturePhase::kEnded, nullptr, "");
      break;
    }
    was_away = true;
    set_report(CapturePhase::kUnavailable, nullptr, status.message());
    pause();
  }
  const std::lock_guard lock(mutex);
  is_finished = true;
  changed.notify_all();
}

// An exception that left this thread would end the daemon.
Result<std::unique_ptr<FrameSource>> CaptureThread::Shared::open_within_memory() const {
  try {
    return open_source(options.url);
  } catch (const std::exception& error) { return Status(ErrorCode::kUnavailable, options.url + ": cannot be opened: " + error.what()); }
}

// Until the source fails or ends (its status is returned), is to be opened again (ok), or a stop is asked for.
Status CaptureThread::Shared::stream(FrameSource& source) {
  while (!should_stop) {
    count(&CaptureCounts::turns);
    CapturedFrame& frame = mailbox.back();
    const Status status = next_frame(source, &frame);
    if (status) {
      on_frame(source, &frame);
      continue;
    }
    if (status.code() == ErrorCode::kCorrupt) {
      count(&CaptureCounts::frames_corrupt);
      supervisor.on_corrupt_frame(monotonic_ns());
    } else if (status.code() != ErrorCode::kTimeout) {
      return status;
    }
    const RecoveryStep step = supervisor.take_due_step(monotonic_ns());
    if (step == RecoveryStep::kNone) continue;
    if (const Status recovery = take_step(source, step); !recovery) supervisor.on_step_failed(monotonic_ns());
    if (step != RecoveryStep::kRestartStream) return Status::ok();
  }
  return Status::ok();
}

// Waits no longer than until a frame is overdue, so that a stall is seen when it begins.
Status CaptureThread::Shared::next_frame(FrameSource& source, CapturedFrame* frame) {
  const std::int64_t now_ns = monotonic_ns();
  read_health(source, now_ns);
  const std::int64_t left_ms = supervisor.time_left_ns(now_ns) / 1'000'000 + 1;
  try {
    return source.next(&frame->buffer, std::chrono::milliseconds(std::min(left_ms, kFrameTimeout_ms)));
  } catch (const std::exception& error) {  // no memory for it, or a library's own
    return {ErrorCode::kUnavailable, options.url + ": a frame failed: " + error.what()};
  }
}

void CaptureThread::Shared::on_frame(FrameSource& source, CapturedFrame* frame) {
  const std::int64_t now_ns = monotonic_ns();
  frame->received_ns = now_ns;
  if (was_away && last_frame_ns != 0) set_recovery(now_ns - last_frame_ns);
  was_away = false;
  last_frame_ns = now_ns;
  if (supervisor.on_frame(now_ns)) {
    set_recovery(supervisor.last_recovery_ns());
    set_report(CapturePhase::kStreaming, &source.info(), "");
  }
  if (options.wait_for_reader) wait_for_reader();
  count(&CaptureCounts::frames_received);
  mailbox.publish();
  wake();
}

// Counted before it is taken: when the step hangs, the counters say where.
Status CaptureThread::Shared::take_step(FrameSource& source, RecoveryStep step) {
  const std::int64_t silence_ns = last_frame_ns == 0 ? 0 : monotonic_ns() - last_frame_ns;
  switch (step) {
    case RecoveryStep::kNone: break;
    case RecoveryStep::kRestartStream:
      count(&CaptureCounts::stalls);
      count(&CaptureCounts::stream_restarts);
      set_report(CapturePhase::kStalled, nullptr, overdue_text(silence_ns, "restarting the stream"));
      return source.restart();
    case RecoveryStep::kReopen: set_report(CapturePhase::kStalled, nullptr, overdue_text(silence_ns, "opening the camera again")); break;
    case RecoveryStep::kResetDevice:
      count(&CaptureCounts::device_resets);
      set_report(CapturePhase::kStalled, nullptr, overdue_text(silence_ns, "resetting the camera"));
      return source.reset_device();
  }
  return Status::ok();
}

void CaptureThread::Shared::count(std::uint64_t CaptureCounts::*counter) {
  const std::lock_guard lock(mutex);
  ++(counts.*counter);
}

void CaptureThread::Shared::set_recovery(std::int64_t duration_ns) {
  const std::lock_guard lock(mutex);
  counts.last_recovery_ns = duration_ns;
}

void CaptureThread::Shared::read_health(FrameSource& source, std::int64_t now_ns) {
  if (now_ns - health_read_ns < kHealthPeriod_ns) return;
  health_read_ns = now_ns;
  const FrameSourceHealth current = source.health();
  const std::lock_guard lock(mutex);
  counts.source = current;
}

// Polls: only recordings wait, and a millisecond is little against the localization of a frame.
void CaptureThread::Shared::wait_for_reader() {
  while (mailbox.has_unread() && !should_stop) {
    count(&CaptureCounts::turns);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

void CaptureThread::Shared::set_report(CapturePhase phase, const FrameSourceInfo* info, const std::string& problem) {
  {
    const std::lock_guard lock(mutex);
    report.phase = phase;
    if (info != nullptr) {
      report.was_open = true;
      report.info = *info;
    }
    report.problem = problem;
  }
  report_number.fetch_add(1, std::memory_order_release);
  wake();
}

void CaptureThread::Shared::pause() {
  std::unique_lock lock(mutex);
  changed.wait_for(lock, options.retry, [this] { return should_stop.load(); });
}

void CaptureThread::Shared::wake() const {
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = ::write(wake_fd, &one, sizeof(one));
}

}  // namespace camloc
