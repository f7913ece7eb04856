// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/v4l2/v4l2_source.h"

#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>

#include "drivers/v4l2/v4l2_opening.h"
#include "drivers/v4l2/v4l2_stream.h"

namespace camloc {

namespace {

constexpr double kUntoldRateHz = 30;  // for pairing, where a driver names no rate
constexpr int kMaxTurns = 64;         // of next(): every buffer of both nodes several times over
constexpr std::int64_t kNsPerMs = 1'000'000;

std::string stream_text(const V4l2Stream& stream) {
  const V4l2ImageLayout& layout = stream.layout();
  char rate[32] = "";
  if (stream.rate_hz() > 0) std::snprintf(rate, sizeof(rate), " at %.4g Hz", stream.rate_hz());
  return stream.device().path() + " '" + stream.device().card() + "' " + fourcc_name(layout.format->fourcc) + " " +
         std::to_string(layout.width) + "x" + std::to_string(layout.height) + rate;
}

std::string stamp_text(V4l2StampSource source) {
  switch (source) {
    case V4l2StampSource::kStartOfExposure: return "stamps of the start of exposure";
    case V4l2StampSource::kEndOfFrame: return "stamps of the end of the frame, taken back by one interval";
    case V4l2StampSource::kArrival: break;
  }
  return "warning: the driver names no clock, so stamps are times of arrival, taken back by one interval";
}

/// A stream and the frame of it that waits for its partner.
struct Channel {
  std::unique_ptr<V4l2Stream> stream;
  std::optional<V4l2Frame> pending;
  bool has_error = false;  ///< poll() said so

  [[nodiscard]] bool lacks_frame() const { return stream && !pending; }
  void release() {
    if (stream && pending) stream->give_back(*pending);
    pending.reset();
  }
};

class V4l2Source final : public FrameSource {
 public:
  explicit V4l2Source(V4l2Opened opened)
      : opened_(std::move(opened)), image_{std::move(opened_.image), {}}, depth_{std::move(opened_.depth), {}} {
    describe();
  }

  [[nodiscard]] const FrameSourceInfo& info() const override { return opened_.info; }

  [[nodiscard]] Status next(FrameBuffer* frame, std::chrono::milliseconds timeout) override {
    if (is_closed()) return {ErrorCode::kUnavailable, "v4l2://: the device was reset; open it again"};
    const std::int64_t deadline_ns = opened_.io->monotonic_ns() + timeout.count() * kNsPerMs;
    for (int turn = 0; turn < kMaxTurns; ++turn) {
      for (Channel* channel : channels()) {
        if (Status status = fill(channel); !status) return status;
      }
      if (is_complete()) return deliver(frame);
      if (drop_without_partner()) continue;
      bool is_late = false;
      if (Status status = wait(deadline_ns, &is_late); !status) return status;
      if (is_late) break;
    }
    return {ErrorCode::kTimeout, "no frame yet"};
  }

  [[nodiscard]] FrameSourceHealth health() const override {
    FrameSourceHealth health;
    for (const Channel* channel : {&image_, &depth_}) {
      if (!channel->stream) continue;
      health.packets_lost += channel->stream->num_lost();
      health.frames_incomplete += channel->stream->num_damaged();
    }
    health.frames_incomplete += num_undecoded_;
    health.frames_unpaired = num_unpaired_;
    return health;
  }

  [[nodiscard]] Status restart() override {
    if (is_closed()) return {ErrorCode::kUnavailable, "v4l2://: the device was reset; open it again"};
    for (Channel* channel : channels()) {
      if (!channel->stream) continue;
      channel->pending.reset();  // stopping takes all buffers back
      channel->has_error = false;
      channel->stream->stop();
    }
    for (Channel* channel : channels()) {
      if (!channel->stream) continue;
      if (Status status = channel->stream->start(); !status) return status;
    }
    return Status::ok();
  }

  [[nodiscard]] Status reset_device() override {
    if (opened_.usb_node.empty()) return {ErrorCode::kUnsupported, "v4l2://: the camera is not on USB"};
    const V4l2Fd device(*opened_.io, opened_.io->open(opened_.usb_node));
    if (device.get() < 0)
      return {ErrorCode::kUnsupported, opened_.usb_node + ": " + errno_text(device.get()) + "; a reset needs the right to write to it"};
    for (Channel* channel : channels()) {
      channel->pending.reset();
      channel->stream.reset();
    }
    const int error = opened_.io->ioctl(device.get(), USBDEVFS_RESET, nullptr);
    // The device may come back as another one, which is a success.
    if (error == 0 || error == -ENODEV) return Status::ok();
    return {ErrorCode::kUnavailable, opened_.usb_node + ": reset failed (" + errno_text(error) + ")"};
  }

 private:
  std::array<Channel*, 2> channels() { return {&image_, &depth_}; }
  [[nodiscard]] bool is_closed() const { return !image_.stream && !depth_.stream; }
  Channel& main_channel() { return image_.stream ? image_ : depth_; }

  Status fill(Channel* channel) {
    if (!channel->lacks_frame()) return Status::ok();
    V4l2Frame frame;
    const Result<bool> has_frame = channel->stream->take(&frame);
    if (!has_frame) return has_frame.status();
    if (*has_frame) channel->pending = frame;
    if (*has_frame || !channel->has_error) return Status::ok();
    return {ErrorCode::kUnavailable, channel->stream->device().path() + ": the driver reports an error and gives no frame"};
  }

  [[nodiscard]] bool is_complete() const {
    if (image_.lacks_frame() || depth_.lacks_frame()) return false;
    return !is_pair() || std::abs(offset_ns()) <= pairing_tolerance_ns();
  }
  [[nodiscard]] bool is_pair() const { return image_.stream && depth_.stream; }
  [[nodiscard]] std::int64_t offset_ns() const { return image_.pending->stamp_ns - depth_.pending->stamp_ns; }
  /// Half the time between two frames of the faster node: no other frame can be nearer.
  [[nodiscard]] std::int64_t pairing_tolerance_ns() const {
    const auto rate_hz = [](const Channel& channel) { return channel.stream->rate_hz() > 0 ? channel.stream->rate_hz() : kUntoldRateHz; };
    return std::llround(0.5e9 / std::max(rate_hz(image_), rate_hz(depth_)));
  }

  /// Of two frames too far apart the older one has no partner any more.
  bool drop_without_partner() {
    if (!is_pair() || !image_.pending || !depth_.pending) return false;
    ++num_unpaired_;
    (offset_ns() < 0 ? image_ : depth_).release();
    return true;
  }

  /// Until a node that lacks a frame has something to say.
  Status wait(std::int64_t deadline_ns, bool* is_late) {
    std::array<pollfd, 2> fds{};
    std::array<Channel*, 2> waiting{};
    std::size_t count = 0;
    for (Channel* channel : channels()) {
      if (!channel->lacks_frame()) continue;
      fds[count] = {channel->stream->device().fd(), POLLIN, 0};
      waiting[count++] = channel;
    }
    const std::int64_t left_ns = std::max<std::int64_t>(deadline_ns - opened_.io->monotonic_ns(), 0);
    const int ready = opened_.io->poll(fds.data(), count, static_cast<int>((left_ns + kNsPerMs - 1) / kNsPerMs));
    if (ready < 0) return {ErrorCode::kUnavailable, "v4l2://: poll: " + errno_text(ready)};
    for (std::size_t i = 0; i < count; ++i) waiting[i]->has_error = (fds[i].revents & (POLLERR | POLLHUP | POLLNVAL)) != 0;
    *is_late = ready == 0 && opened_.io->monotonic_ns() >= deadline_ns;
    return Status::ok();
  }

  Status deliver(FrameBuffer* frame) {
    Channel& main = main_channel();
    frame->sequence = main.pending->exposure;
    frame->stamp_ns = main.pending->stamp_ns + opened_.stamp_offset_ns;
    if (main.stream->stamp_source() != described_source_) describe();
    Status status = convert(frame);
    for (Channel* channel : channels()) channel->release();
    if (!status) ++num_undecoded_;
    return status;
  }

  Status convert(FrameBuffer* frame) {
    if (!image_.stream) frame->gray.resize(0, 0);
    if (!depth_.stream) frame->depth.resize(0, 0);
    if (!opened_.gives_color) frame->color.resize(0, 0);
    if (depth_.stream) convert_to_depth(depth_.stream->layout(), depth_.pending->planes, &frame->depth);
    if (!image_.stream) return Status::ok();
    const V4l2ImageLayout& layout = image_.stream->layout();
    const unsigned bits = opened_.gray_bits.value_or(layout.format->significant_bits);
    if (Status status = convert_to_gray(layout, image_.pending->planes, bits, &frame->gray); !status || !opened_.gives_color) return status;
    return convert_to_bgr(layout, image_.pending->planes, &scratch_, &frame->color);
  }

  void describe() {
    described_source_ = main_channel().stream->stamp_source();
    opened_.info.description.clear();
    if (image_.stream) opened_.info.description = stream_text(*image_.stream);
    if (depth_.stream) opened_.info.description += (image_.stream ? ", depth " : "depth ") + stream_text(*depth_.stream);
    opened_.info.description += "; " + stamp_text(described_source_);
  }

  V4l2Opened opened_;
  Channel image_, depth_;  // after opened_.io, which they use until they are gone
  V4l2StampSource described_source_ = V4l2StampSource::kArrival;
  std::uint64_t num_unpaired_ = 0;
  std::uint64_t num_undecoded_ = 0;
  Image<std::uint8_t> scratch_;
};

}  // namespace

Result<std::unique_ptr<FrameSource>> open_v4l2_source_on(std::shared_ptr<V4l2Io> io, const SystemFolders& folders, const SourceUrl& url,
                                                         const FrameSourceOptions& options) {
  Result<V4l2Opened> opened = open_v4l2_nodes(std::move(io), folders, url, options);
  if (!opened) return opened.status();
  return std::unique_ptr<FrameSource>(std::make_unique<V4l2Source>(std::move(opened).value()));
}

Result<std::unique_ptr<FrameSource>> open_v4l2_source(const SourceUrl& url, const FrameSourceOptions& options) {
  return open_v4l2_source_on(make_system_v4l2_io(), {}, url, options);
}

}  // namespace camloc
