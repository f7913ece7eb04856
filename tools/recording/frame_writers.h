// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The queue between a frame source and the disk, and the threads that empty it. Frames are encoded side by side and named in the
// index in the order in which they came.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <queue>
#include <thread>
#include <vector>

#include "core/base/frame.h"
#include "core/base/result.h"
#include "tools/recording/recording_folder.h"

namespace camloc::tools {

/// push() and the counters may be used from one thread beside the writers.
class FrameWriters {
 public:
  struct Totals {
    std::uint64_t frames = 0, frames_with_depth = 0, bytes = 0;
    int queued = 0;
    Status failure;  ///< of the first frame that could not be written; nothing is written after it
  };

  /// `folder` outlives this object. Buffers for `queue_frames` frames are kept and reused.
  FrameWriters(RecordingFolder* folder, int queue_frames, int num_writers);
  ~FrameWriters();
  FrameWriters(const FrameWriters&) = delete;
  FrameWriters& operator=(const FrameWriters&) = delete;

  /// Takes the frame by exchanging it for a used buffer. False: the queue is full, and stayed full for `patience`.
  [[nodiscard]] bool push(FrameBuffer* frame, std::int64_t stamp_ns, const std::optional<Eigen::Vector3d>& acceleration,
                          std::chrono::milliseconds patience);
  [[nodiscard]] Totals totals() const;
  /// Waits until the queue is empty or writing failed, and ends the threads. Returns how many frames were left behind.
  std::uint64_t finish();

 private:
  struct Slot {
    FrameBuffer frame;
    std::int64_t stamp_ns = 0;
    std::optional<Eigen::Vector3d> acceleration;
    std::uint64_t ticket = 0;
  };
  struct Written {
    std::int64_t stamp_ns;
    bool has_depth;
    std::optional<Eigen::Vector3d> acceleration;
    std::uint64_t bytes;
  };

  void run();
  void commit(std::uint64_t ticket, const Written& written);

  RecordingFolder* folder_;
  mutable std::mutex mutex_;
  std::condition_variable has_work_, has_room_;
  std::vector<Slot> slots_;
  std::vector<std::size_t> free_;
  std::queue<std::size_t> pending_;
  std::map<std::uint64_t, Written> written_;  // not yet named in the index: a frame before them is still being written
  std::uint64_t next_ticket_ = 0, next_commit_ = 0;
  bool is_closed_ = false;
  Totals totals_;
  std::vector<std::thread> threads_;
};

}  // namespace camloc::tools
