// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/coarse_worker.h"

#include <malloc.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <memory>
#include <utility>

namespace camloc {
namespace {

template <typename T>
void copy(const ImageView<T>& from, Image<T>* to) {
  to->resize(from.width, from.height);
  for (int y = 0; y < from.height; ++y) std::copy(from.row(y), from.row(y) + from.width, to->row(y));
}

/// A model that is there, of this map.
Result<CoarseModel> read_model(const std::string& path, std::uint64_t map_id) {
  Result<CoarseModel> model = read_coarse_model(path);
  if (!model) return model;
  if (Status status = check_coarse_map(model->info, map_id); !status) return status.with_context(path);
  return model;
}

}  // namespace

CoarseWorkerOptions coarse_worker_options(const std::string& model_path, std::uint64_t map_id, const RgbdCamera& camera) {
  CoarseWorkerOptions options;
  options.check = [=] { return read_model(model_path, map_id).status(); };
  // The file is read anew each time: in between its weights take no memory.
  options.load = [=]() -> Result<LocateFrame> {
    const Result<CoarseModel> model = read_model(model_path, map_id);
    if (!model) return model.status();
    Result<CoarseNetwork> network = CoarseNetwork::load(*model, camera);
    if (!network) return network.status();
    return LocateFrame(
        [shared = std::make_shared<CoarseNetwork>(std::move(*network))](const Frame& frame) { return shared->locate(frame); });
  };
  options.color_width = camera.color.width, options.color_height = camera.color.height;
  options.depth_width = camera.depth.width, options.depth_height = camera.depth.height;
  return options;
}

const char* to_string(CoarsePhase phase) {
  switch (phase) {
    case CoarsePhase::kChecking: return "checking";
    case CoarsePhase::kReady: return "ready";
    case CoarsePhase::kLoaded: return "loaded";
    case CoarsePhase::kFailed: return "failed";
  }
  return "";
}

CoarseWorker::CoarseWorker(CoarseWorkerOptions options) : options_(std::move(options)), wake_fd_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
  mailbox_.reserve(options_.color_width, options_.color_height, options_.depth_width, options_.depth_height);
  thread_ = std::thread([this] { run(); });
}

CoarseWorker::~CoarseWorker() {
  should_stop_ = true;
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = ::write(wake_fd_.get(), &one, sizeof one);
  thread_.join();
}

void CoarseWorker::offer(const Frame& frame) {
  if (phase() == CoarsePhase::kFailed) return;
  FrameBuffer& buffer = mailbox_.back().buffer;
  buffer.sequence = frame.sequence;
  buffer.stamp_ns = frame.stamp_ns;
  copy(frame.gray, &buffer.gray);
  copy(frame.depth, &buffer.depth);
  mailbox_.publish();
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = ::write(wake_fd_.get(), &one, sizeof one);
}

std::optional<CoarseHint> CoarseWorker::take() {
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock) return std::nullopt;  // it is just being written: with the next frame
  return std::exchange(hint_, std::nullopt);
}

std::string CoarseWorker::problem() const {
  const std::lock_guard lock(mutex_);
  return problem_;
}

/// False when the time is over.
bool CoarseWorker::wait(std::int64_t timeout_ns) const {
  pollfd fd{wake_fd_.get(), POLLIN, 0};
  const int timeout_ms = timeout_ns < 0 ? -1 : static_cast<int>(timeout_ns / 1'000'000);
  const bool is_awake = ::poll(&fd, 1, timeout_ms) != 0;
  std::uint64_t count = 0;
  [[maybe_unused]] const ssize_t got = ::read(wake_fd_.get(), &count, sizeof count);
  return is_awake;
}

void CoarseWorker::run() {
  if (const Status status = options_.check(); !status) return fail(status);
  ::malloc_trim(0);
  phase_ = CoarsePhase::kReady;
  while (!should_stop_) {
    const bool is_awake = wait(locate_ ? options_.idle_ns : -1);
    if (!is_awake) {
      locate_ = nullptr;
      ::malloc_trim(0);
      phase_ = CoarsePhase::kReady;
    }
    const CapturedFrame* frame = should_stop_ ? nullptr : mailbox_.take();
    if (frame == nullptr) continue;
    if (!locate_) {
      Result<LocateFrame> loaded = options_.load();
      ::malloc_trim(0);  // what reading it took
      if (!loaded) return fail(loaded.status());
      locate_ = std::move(*loaded);
      phase_ = CoarsePhase::kLoaded;
    }
    answer(frame->buffer.view());
  }
  locate_ = nullptr;
}

// A frame that gives no pose is no failure: the next one is another.
void CoarseWorker::answer(const Frame& frame) {
  const Result<CoarsePose> pose = locate_(frame);
  if (!pose) return;
  num_answers_.fetch_add(1, std::memory_order_relaxed);
  const std::lock_guard lock(mutex_);
  hint_ = CoarseHint{pose->stamp_ns, pose->T_map_camera, pose->covariance};
}

void CoarseWorker::fail(const Status& status) {
  {
    const std::lock_guard lock(mutex_);
    problem_ = status.message();
  }
  phase_ = CoarsePhase::kFailed;
}

}  // namespace camloc
