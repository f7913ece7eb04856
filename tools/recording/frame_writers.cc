// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Frames get a ticket when they come; a writer that is done puts its result aside until all earlier tickets are in the index. The
// lock is held to exchange buffers and to append lines, never while an image is encoded.
#include "tools/recording/frame_writers.h"

#include <cassert>
#include <numeric>
#include <utility>

namespace camloc::tools {

FrameWriters::FrameWriters(RecordingFolder* folder, int queue_frames, int num_writers)
    : folder_(folder), slots_(static_cast<std::size_t>(queue_frames)), free_(slots_.size()) {
  assert(queue_frames > 0 && num_writers > 0);
  std::iota(free_.begin(), free_.end(), std::size_t{0});
  for (int i = 0; i < num_writers; ++i) threads_.emplace_back([this] { run(); });
}

FrameWriters::~FrameWriters() { finish(); }

bool FrameWriters::push(FrameBuffer* frame, std::int64_t stamp_ns, const std::optional<Eigen::Vector3d>& acceleration,
                        std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  if (!has_room_.wait_for(lock, patience, [this] { return !free_.empty(); })) return false;
  const std::size_t index = free_.back();
  free_.pop_back();
  Slot& slot = slots_[index];
  std::swap(slot.frame, *frame);
  slot.stamp_ns = stamp_ns;
  slot.acceleration = acceleration;
  slot.ticket = next_ticket_++;
  pending_.push(index);
  lock.unlock();
  has_work_.notify_one();
  return true;
}

FrameWriters::Totals FrameWriters::totals() const {
  const std::lock_guard lock(mutex_);
  Totals totals = totals_;
  totals.queued = static_cast<int>(pending_.size());
  return totals;
}

void FrameWriters::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    has_work_.wait(lock, [this] { return is_closed_ || !pending_.empty(); });
    if (pending_.empty() || !totals_.failure) return;
    const std::size_t index = pending_.front();
    pending_.pop();
    const Slot& slot = slots_[index];
    lock.unlock();
    const Result<std::uint64_t> bytes = folder_->write_images(slot.frame, slot.stamp_ns);
    lock.lock();
    if (bytes) {
      commit(slot.ticket, {slot.stamp_ns, !slot.frame.depth.pixels.empty(), slot.acceleration, *bytes});
    } else if (totals_.failure) {
      totals_.failure = bytes.status();
      has_work_.notify_all();
    }
    free_.push_back(index);
    has_room_.notify_one();
  }
}

/// Names what is whole and whose turn it is. The lines are short: the lock is held for microseconds.
void FrameWriters::commit(std::uint64_t ticket, const Written& done) {
  written_.emplace(ticket, done);
  for (auto first = written_.begin(); first != written_.end() && first->first == next_commit_ && totals_.failure;
       first = written_.begin()) {
    const Written& written = first->second;
    Status status = folder_->append_frame(written.stamp_ns, written.has_depth);
    if (status && written.acceleration) status = folder_->append_acceleration(written.stamp_ns, *written.acceleration);
    if (!status) {
      totals_.failure = status;
      return;
    }
    ++totals_.frames;
    totals_.frames_with_depth += written.has_depth ? 1 : 0;
    totals_.bytes += written.bytes;
    ++next_commit_;
    written_.erase(first);
  }
}

std::uint64_t FrameWriters::finish() {
  {
    const std::lock_guard lock(mutex_);
    is_closed_ = true;
  }
  has_work_.notify_all();
  for (std::thread& thread : threads_) thread.join();
  threads_.clear();
  return next_ticket_ - totals_.frames;
}

}  // namespace camloc::tools
