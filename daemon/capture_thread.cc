// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Open, stream, retry.
#include "daemon/capture_thread.h"

#include <unistd.h>

#include <utility>

#include "daemon/clock.h"

namespace camloc {

CaptureThread::CaptureThread(const CaptureOptions& options, OpenSource open_source, int wake_fd)
    : shared_(std::make_shared<Shared>()) {
  shared_->options = options;
  shared_->open_source = std::move(open_source);
  shared_->wake_fd = wake_fd;
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

void CaptureThread::Shared::run() {
  bool was_open = false;
  while (!should_stop) {
    num_turns.fetch_add(1, std::memory_order_relaxed);
    Result<std::unique_ptr<FrameSource>> source = open_source(options.url);
    Status status = source.status();
    if (source) {
      if (was_open) num_restarts.fetch_add(1, std::memory_order_relaxed);
      was_open = true;
      set_report(CapturePhase::kStreaming, &(*source)->info(), "");
      status = stream(**source);
      source.value().reset();  // give the device back before pausing
    }
    if (should_stop) break;
    if (status.code() == ErrorCode::kEnd) {
      set_report(CapturePhase::kEnded, nullptr, "");
      break;
    }
    set_report(CapturePhase::kUnavailable, nullptr, status.message());
    pause();
  }
  const std::lock_guard lock(mutex);
  is_finished = true;
  changed.notify_all();
}

// Until the source fails (its status is returned), ends, or a stop is asked for.
Status CaptureThread::Shared::stream(FrameSource& source) {
  while (!should_stop) {
    num_turns.fetch_add(1, std::memory_order_relaxed);
    CapturedFrame& frame = mailbox.back();
    const Status status = source.next(&frame.buffer, options.frame_timeout);
    if (status.code() == ErrorCode::kTimeout) continue;
    if (status.code() == ErrorCode::kCorrupt) {
      num_corrupt.fetch_add(1, std::memory_order_relaxed);
      continue;
    }
    if (!status) return status;
    frame.received_ns = monotonic_ns();
    if (options.wait_for_reader) wait_for_reader();
    num_received.fetch_add(1, std::memory_order_relaxed);
    mailbox.publish();
    wake();
  }
  return Status::ok();
}

// Polls: only recordings wait, and a millisecond is little against the localization of a frame.
void CaptureThread::Shared::wait_for_reader() {
  while (mailbox.has_unread() && !should_stop) {
    num_turns.fetch_add(1, std::memory_order_relaxed);
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
