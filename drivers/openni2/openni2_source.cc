// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The library's threads fill its own buffers; this one waits, in short slices so that a device that
// went away is noticed, converts what came at once and keeps the newest images and depths until two of one time make a pair.
#include "drivers/openni2/openni2_source.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <utility>

#include "drivers/device_clock.h"
#include "drivers/openni2/openni2_device.h"

namespace camloc {

namespace {

using openni2::Device;
using openni2::RawImage;
using openni2::Stream;

constexpr std::chrono::milliseconds kWaitSlice(20);

/// A frame of one stream, until it is paired.
struct Entry {
  bool is_fresh = false;
  std::uint64_t sequence = 0;
  std::int64_t device_ns = 0;
  std::int64_t arrival_ns = 0;
  std::int64_t stamp_ns = 0;
  Image<std::uint8_t> gray;
  Image<Bgr> color;
  Image<std::uint16_t> depth;
};

/// The newest frames of a stream: three, as one stream may come two frames later than the other.
using Entries = std::array<Entry, 3>;

/// A free place, or that of the oldest frame.
Entry* place_in(Entries* entries) {
  const auto is_older = [](const Entry& a, const Entry& b) { return a.is_fresh != b.is_fresh ? !a.is_fresh : a.arrival_ns < b.arrival_ns; };
  return &*std::min_element(entries->begin(), entries->end(), is_older);
}

/// Frees the places of all frames that came up to `last`; how many there were besides `last`.
std::uint64_t drop_through(Entries* entries, const Entry& last) {
  std::uint64_t count = 0;
  for (Entry& entry : *entries) {
    if (!entry.is_fresh || entry.arrival_ns > last.arrival_ns) continue;
    entry.is_fresh = false;
    count += &entry != &last;
  }
  return count;
}

class Openni2Source final : public FrameSource {
 public:
  Openni2Source(std::unique_ptr<Device> device, FrameSourceInfo info, bool wants_color)
      : device_(std::move(device)),
        info_(std::move(info)),
        wants_color_(wants_color),
        max_pair_gap_ns_(600'000'000 / device_->image().mode.fps) {
    // All memory now, none per frame.
    for (Entry& entry : images_) {
      entry.gray.resize(info_.color_width, info_.color_height);
      if (wants_color_) entry.color.resize(info_.color_width, info_.color_height);
    }
    for (Entry& entry : depths_) entry.depth.resize(info_.depth_width, info_.depth_height);
  }

  [[nodiscard]] const FrameSourceInfo& info() const override { return info_; }

  [[nodiscard]] Status next(FrameBuffer* frame, std::chrono::milliseconds timeout) override {
    const auto deadline = std::chrono::steady_clock::now() + timeout;
    // More frames than any wait brings; a driver gone mad must not keep us here.
    for (int num_reads = 0; num_reads < 1000; ++num_reads) {
      if (device_->is_gone()) return {ErrorCode::kUnavailable, "OpenNI2 device " + device_->uri() + ": is gone"};
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
      Result<bool> has_read = read_one(std::clamp(left, std::chrono::milliseconds(0), kWaitSlice));
      if (!has_read) return has_read.status();
      if (*has_read && give_pair(frame)) return Status::ok();
      if (left <= std::chrono::milliseconds(0)) break;
    }
    return {ErrorCode::kTimeout, "no frame from OpenNI2 device " + device_->uri()};
  }

  [[nodiscard]] FrameSourceHealth health() const override {
    FrameSourceHealth health;
    health.frames_incomplete = num_incomplete_;
    health.frames_unpaired = num_unpaired_;
    health.clock_drift_ppm = image_clock_.drift_ppm();
    return health;
  }

  [[nodiscard]] Status restart() override {
    if (device_->is_gone()) return {ErrorCode::kUnavailable, "OpenNI2 device " + device_->uri() + ": is gone"};
    device_->stop();
    // It said it would deliver both in step, and delivered nothing.
    if (!has_delivered_) device_->disable_sync();
    for (Entry& entry : images_) entry.is_fresh = false;
    for (Entry& entry : depths_) entry.is_fresh = false;
    newest_image_ = newest_depth_ = nullptr;
    image_clock_.reset();
    depth_clock_.reset();
    has_compared_clocks_ = false;
    has_delivered_ = false;
    Status status = device_->start();
    info_.description = device_->description();
    return status;
  }

 private:
  /// Waits for one frame of any stream and keeps it. False: none came.
  Result<bool> read_one(std::chrono::milliseconds timeout) {
    const openni2::Api& api = device_->session().api();
    OniStreamHandle streams[2] = {device_->image().handle, device_->depth().handle};
    int index = -1;
    const OniStatus waited = api.wait_for_any_stream(streams, device_->has_depth() ? 2 : 1, &index, static_cast<int>(timeout.count()));
    if (waited == ONI_STATUS_TIME_OUT) return false;
    if (waited != ONI_STATUS_OK || index < 0 || index > 1) return device_->error("waiting for a frame failed");
    OniFrame* raw = nullptr;
    if (api.stream_read_frame(streams[index], &raw) != ONI_STATUS_OK || raw == nullptr) return device_->error("reading a frame failed");
    const Status status = keep(*raw, index == 0);
    api.frame_release(raw);
    if (status) return true;
    ++num_incomplete_;
    return status;
  }

  Status keep(const OniFrame& raw, bool is_image) {
    constexpr std::uint64_t kMaxStampUs = 4'000'000'000'000'000;
    const std::int64_t arrival_ns = steady_now_ns();
    const Stream& stream = is_image ? device_->image() : device_->depth();
    if (is_image) ++sequence_;
    const auto bad = [&](const std::string& why) {
      return Status(ErrorCode::kCorrupt,
                    std::string(is_image ? "image" : "depth") + " frame " + std::to_string(raw.frameIndex) + ": " + why);
    };
    if (raw.data == nullptr || raw.dataSize <= 0 || raw.stride <= 0) return bad("empty");
    if (raw.width != stream.mode.resolutionX || raw.height != stream.mode.resolutionY || raw.croppingEnabled != FALSE ||
        raw.videoMode.pixelFormat != stream.mode.pixelFormat) {
      return bad(std::to_string(raw.width) + "x" + std::to_string(raw.height) + " in format " + std::to_string(raw.videoMode.pixelFormat) +
                 " instead of " + openni2::describe(stream.mode));
    }
    if (raw.timestamp > kMaxStampUs) return bad("stamp out of range");
    const RawImage pixels{{static_cast<const std::uint8_t*>(raw.data), static_cast<std::size_t>(raw.dataSize)},
                          raw.width,
                          raw.height,
                          static_cast<std::size_t>(raw.stride),
                          stream.pixels.layout,
                          stream.is_mirrored};
    Entry* entry = place_in(is_image ? &images_ : &depths_);
    if (std::exchange(entry->is_fresh, false)) ++num_unpaired_;
    Status status = is_image ? to_gray(pixels, &entry->gray) : to_depth(pixels, &entry->depth);
    if (status && is_image && wants_color_) status = to_bgr(pixels, &entry->color);
    if (!status) return bad(status.message());
    entry->is_fresh = true;
    entry->sequence = sequence_;
    entry->device_ns = static_cast<std::int64_t>(raw.timestamp) * 1000;
    entry->arrival_ns = arrival_ns;
    entry->stamp_ns = (is_image ? image_clock_ : depth_clock_).to_monotonic(entry->device_ns, arrival_ns);
    (is_image ? newest_image_ : newest_depth_) = entry;
    return Status::ok();
  }

  /// Gives the two kept frames away that are nearest in time, if they are near enough, and forgets what is older.
  bool give_pair(FrameBuffer* frame) {
    Entry* image = newest_image_;
    Entry* depth = nullptr;
    if (device_->has_depth() && !find_pair(&image, &depth)) return false;
    if (image == nullptr || !image->is_fresh) return false;
    num_unpaired_ += drop_through(&images_, *image);
    if (depth != nullptr) num_unpaired_ += drop_through(&depths_, *depth);
    frame->sequence = image->sequence;
    frame->stamp_ns = image->stamp_ns;
    std::swap(frame->gray, image->gray);
    if (wants_color_) std::swap(frame->color, image->color);
    if (!wants_color_) frame->color.resize(0, 0);
    if (depth != nullptr) std::swap(frame->depth, depth->depth);
    if (depth == nullptr) frame->depth.resize(0, 0);
    has_delivered_ = true;
    return true;
  }

  bool find_pair(Entry** image, Entry** depth) {
    if (newest_image_ == nullptr || newest_depth_ == nullptr) return false;
    if (!has_compared_clocks_) compare_clocks();
    std::int64_t best_gap_ns = max_pair_gap_ns_ + 1;
    for (Entry& i : images_) {
      for (Entry& d : depths_) {
        if (!i.is_fresh || !d.is_fresh) continue;
        const std::int64_t gap_ns = std::llabs(has_shared_clock_ ? i.device_ns - d.device_ns : i.stamp_ns - d.stamp_ns);
        if (gap_ns >= best_gap_ns) continue;
        best_gap_ns = gap_ns;
        *image = &i;
        *depth = &d;
      }
    }
    return best_gap_ns <= max_pair_gap_ns_;
  }

  /// Most devices stamp both streams with one clock; some count each from its own start.
  void compare_clocks() {
    constexpr std::int64_t kSameClockNs = 500'000'000;
    const std::int64_t apart_ns =
        (newest_image_->device_ns - newest_depth_->device_ns) - (newest_image_->arrival_ns - newest_depth_->arrival_ns);
    has_compared_clocks_ = true;
    has_shared_clock_ = std::llabs(apart_ns) < kSameClockNs;
  }

  std::unique_ptr<Device> device_;
  FrameSourceInfo info_;
  bool wants_color_;
  std::int64_t max_pair_gap_ns_;
  Entries images_, depths_;
  Entry* newest_image_ = nullptr;
  Entry* newest_depth_ = nullptr;
  DeviceClock image_clock_, depth_clock_;
  bool has_compared_clocks_ = false;
  bool has_shared_clock_ = true;
  bool has_delivered_ = false;
  std::uint64_t sequence_ = 0;
  std::uint64_t num_incomplete_ = 0;
  std::uint64_t num_unpaired_ = 0;
};

FrameSourceInfo describe(const Device& device) {
  FrameSourceInfo info;
  info.description = device.description();
  info.serial = device.serial();
  info.color_width = device.image().mode.resolutionX;
  info.color_height = device.image().mode.resolutionY;
  info.depth_width = device.depth().mode.resolutionX;
  info.depth_height = device.depth().mode.resolutionY;
  info.camera = device.camera();
  info.stamp_clock = StampClock::kMonotonic;
  return info;
}

}  // namespace

Result<std::unique_ptr<FrameSource>> open_openni2_source(const SourceUrl& url, const FrameSourceOptions& options) {
  if (Status status = url.check_options({"width", "height", "rate_hz"}); !status) return status;
  OptionReader wanted(url);
  const double width = wanted.number("width", 0, 1, 16384), height = wanted.number("height", 0, 1, 16384);
  const double rate_hz = wanted.number("rate_hz", 0, 1, 1000);
  if (!wanted.status()) return wanted.status();
  Result<std::unique_ptr<Device>> device =
      Device::open(url.path, {static_cast<int>(width), static_cast<int>(height), static_cast<int>(rate_hz)});
  if (!device) return device.status();
  if (Status status = (*device)->start(); !status) return status;
  FrameSourceInfo info = describe(**device);
  return std::unique_ptr<FrameSource>(std::make_unique<Openni2Source>(std::move(device).value(), std::move(info), options.wants_color));
}

}  // namespace camloc
