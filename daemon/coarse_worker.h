// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Asks a neural network where the camera is while the localizer does not know, in a thread of its own. The network is loaded when the
// first frame is lost and given back when no frame was lost for a while. The frame path hands frames over and takes answers without
// waiting for either.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "core/base/frame.h"
#include "core/base/result.h"
#include "core/base/unique_fd.h"
#include "core/coarse/coarse_network.h"
#include "core/localize/coarse_hint.h"
#include "daemon/frame_mailbox.h"

namespace camloc {

/// The network, once it is loaded; destroying it gives it back.
using LocateFrame = std::function<Result<CoarsePose>(const Frame&)>;

struct CoarseWorkerOptions {
  std::function<Status()> check;              ///< can it be loaded at all? Asked once, at the start
  std::function<Result<LocateFrame>()> load;  ///< a failure ends the work: it would not be another one the next time
  std::int64_t idle_ns = 30'000'000'000;      ///< without a lost frame, before the network is given back
  int color_width = 0, color_height = 0;      ///< pixels: buffers are made for these
  int depth_width = 0, depth_height = 0;
};

/// The network of `model_path` for a map and a camera.
[[nodiscard]] CoarseWorkerOptions coarse_worker_options(const std::string& model_path, std::uint64_t map_id, const RgbdCamera& camera);

enum class CoarsePhase : std::uint8_t {
  kChecking,  ///< the model is being looked at
  kReady,     ///< not in memory; the next lost frame loads it
  kLoaded,
  kFailed,  ///< problem() says why; nothing more will come
};

/// One word: checking, ready, loaded, failed.
[[nodiscard]] const char* to_string(CoarsePhase phase);

/// The thread lives as long as this; destruction waits for what the network is at, a fraction of a second. offer() and take() are for
/// one other thread: they neither wait nor allocate.
class CoarseWorker {
 public:
  explicit CoarseWorker(CoarseWorkerOptions options);
  ~CoarseWorker();
  CoarseWorker(const CoarseWorker&) = delete;
  CoarseWorker& operator=(const CoarseWorker&) = delete;

  /// This frame was lost. It is copied (0.1 ms); a newer one replaces it where the network is not done with the last.
  void offer(const Frame& frame);
  /// The newest answer, once.
  [[nodiscard]] std::optional<CoarseHint> take();

  [[nodiscard]] CoarsePhase phase() const { return phase_.load(std::memory_order_acquire); }
  [[nodiscard]] std::int64_t num_answers() const { return num_answers_.load(std::memory_order_relaxed); }
  /// One line, where the phase is kFailed.
  [[nodiscard]] std::string problem() const;

 private:
  void run();
  [[nodiscard]] bool wait(std::int64_t timeout_ns) const;
  void answer(const Frame& frame);
  void fail(const Status& status);

  CoarseWorkerOptions options_;
  UniqueFd wake_fd_;
  FrameMailbox mailbox_;
  LocateFrame locate_;  ///< the thread's own
  std::atomic<bool> should_stop_{false};
  std::atomic<CoarsePhase> phase_{CoarsePhase::kChecking};
  std::atomic<std::int64_t> num_answers_{0};
  mutable std::mutex mutex_;  ///< the rest; held for a copy
  std::optional<CoarseHint> hint_;
  std::string problem_;
  std::thread thread_;
};

}  // namespace camloc
