// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Hands camera frames from the capture thread to the localizer: the newest wins, what it replaces is counted as dropped.
// Three buffers change owner by one atomic exchange: writer, newest, reader. Nobody ever holds a lock, least of all while
// working on pixels, and nothing is copied.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include "core/base/frame.h"

namespace camloc {

struct CapturedFrame {
  FrameBuffer buffer;
  std::int64_t received_ns = 0;  ///< monotonic clock, when the capture thread had it complete
};

/// One writer thread, one reader thread.
class FrameMailbox {
 public:
  /// Before either begins: memory for frames of these sizes, so that the first ones allocate nothing.
  void reserve(int color_width, int color_height, int depth_width, int depth_height) {
    for (CapturedFrame& frame : buffers_) {
      frame.buffer.gray.resize(color_width, color_height);
      frame.buffer.depth.resize(depth_width, depth_height);
    }
  }

  /// Writer: the buffer to fill next; keeps its memory from earlier frames.
  [[nodiscard]] CapturedFrame& back() { return buffers_[back_]; }

  /// Writer: back() becomes the newest frame, and another buffer the new back().
  void publish() {
    const std::uint32_t previous = newest_.exchange(back_ | kFresh, std::memory_order_acq_rel);
    back_ = previous & kIndex;
    if ((previous & kFresh) != 0) num_dropped_.fetch_add(1, std::memory_order_relaxed);
  }

  /// Reader: the newest frame that was not taken yet, valid until the next take(); nullptr when there is none.
  [[nodiscard]] const CapturedFrame* take() {
    if (!has_unread()) return nullptr;
    // Only the reader clears the mark, so the frame is still fresh, if perhaps a newer one by now.
    front_ = newest_.exchange(front_, std::memory_order_acq_rel) & kIndex;
    return &buffers_[front_];
  }

  /// Either thread.
  [[nodiscard]] bool has_unread() const { return (newest_.load(std::memory_order_acquire) & kFresh) != 0; }
  [[nodiscard]] std::uint64_t num_dropped() const { return num_dropped_.load(std::memory_order_relaxed); }

 private:
  static constexpr std::uint32_t kIndex = 3, kFresh = 4;

  std::array<CapturedFrame, 3> buffers_;
  std::atomic<std::uint32_t> newest_{1};
  std::atomic<std::uint64_t> num_dropped_{0};
  std::uint32_t back_ = 0;   // writer's
  std::uint32_t front_ = 2;  // reader's
};

}  // namespace camloc
