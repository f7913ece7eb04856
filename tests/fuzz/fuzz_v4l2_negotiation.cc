// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A driver that answers every ioctl with arbitrary bytes: opening, listing, controls, frames, restart. Each mapping is a block of
// the heap of just the length that was asked for, so that AddressSanitizer sees a read beyond it. A frame that is delivered has
// the sizes that were announced.
#include <linux/videodev2.h>
#include <sys/ioctl.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "drivers/v4l2/v4l2_source.h"

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

constexpr std::size_t kMaxMappedBytes = std::size_t{1} << 22;  // larger frames take time and show nothing new
constexpr int kMaxErrno = 134;

/// Takes its answers from the input, one after the other; at its end every call fails.
class HostileDriver final : public camloc::V4l2Io {
 public:
  HostileDriver(const std::uint8_t* data, std::size_t size) : data_(data), left_(size) {}
  ~HostileDriver() override { require(mapped_.empty() && num_open_ == 0); }

  [[nodiscard]] int open(const std::string& /*path*/) override {
    if (left_ == 0) return -ENOENT;
    ++num_open_;
    return 3;
  }
  void close(int /*fd*/) override { --num_open_; }

  // First a byte: 0 to 199 the call works and the answer is changed by the next bytes, else it fails.
  [[nodiscard]] int ioctl(int /*fd*/, unsigned long request, void* argument) override {
    const unsigned kind = byte();
    if (left_ == 0) return -ENODEV;
    if (kind >= 200) return kind == 200 ? -EAGAIN : -static_cast<int>(1 + byte() % kMaxErrno);
    if (argument == nullptr) return 0;
    v4l2_plane* planes = planes_of(request, argument);
    // The size is in the request's number; most answers are a few changes to what was asked.
    change(argument, _IOC_SIZE(request), kind);
    if (planes != nullptr) {
      static_cast<v4l2_buffer*>(argument)->m.planes = planes;
      change(planes, VIDEO_MAX_PLANES * sizeof(v4l2_plane), kind);
    }
    return 0;
  }

  [[nodiscard]] const std::uint8_t* map(int /*fd*/, std::size_t length, std::int64_t /*offset*/) override {
    if (length == 0 || length > kMaxMappedBytes) return nullptr;
    auto block = std::make_unique<std::uint8_t[]>(length);
    for (std::size_t i = 0; i < std::min<std::size_t>(length, 64); ++i) block[i] = static_cast<std::uint8_t>(byte());
    const std::uint8_t* bytes = block.get();
    mapped_.emplace(bytes, std::pair(std::move(block), length));
    return bytes;
  }
  void unmap(const std::uint8_t* bytes, std::size_t length) override {
    require(mapped_.contains(bytes) && mapped_.at(bytes).second == length);
    mapped_.erase(bytes);
  }

  [[nodiscard]] int poll(pollfd* fds, std::size_t count, int timeout_ms) override {
    now_ns_ += std::int64_t{std::max(timeout_ms, 1)} * 1'000'000;
    for (std::size_t i = 0; i < count; ++i) fds[i].revents = static_cast<short>(byte());
    return static_cast<int>(byte()) - 20;
  }
  [[nodiscard]] std::int64_t monotonic_ns() override { return now_ns_ += 1000; }

 private:
  unsigned byte() {
    if (left_ == 0) return 0;
    --left_;
    return *data_++;
  }
  static v4l2_plane* planes_of(unsigned long request, void* argument) {
    if (request != VIDIOC_QUERYBUF && request != VIDIOC_DQBUF && request != VIDIOC_QBUF) return nullptr;
    const auto* buffer = static_cast<const v4l2_buffer*>(argument);
    return buffer->type == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE ? buffer->m.planes : nullptr;
  }
  /// Kinds below 100: up to 15 pieces of four bytes are written at offsets of the input's choice; above: so many pieces from the
  /// front, which is how an honest driver's answers are written down as seeds.
  void change(void* argument, std::size_t size, unsigned kind) {
    auto* bytes = static_cast<std::uint8_t*>(argument);
    if (kind >= 100) {
      for (std::size_t i = 0; i < size && i < 4 * std::size_t{kind - 100}; ++i) bytes[i] = static_cast<std::uint8_t>(byte());
      return;
    }
    for (unsigned i = 0; i < kind % 16 && size >= 4; ++i) {
      const std::size_t offset = byte() * 4 % (size / 4 * 4);
      for (std::size_t j = 0; j < 4; ++j) bytes[offset + j] = static_cast<std::uint8_t>(byte());
    }
  }

  const std::uint8_t* data_;
  std::size_t left_;
  int num_open_ = 0;
  std::int64_t now_ns_ = 50'000'000'000;
  std::map<const std::uint8_t*, std::pair<std::unique_ptr<std::uint8_t[]>, std::size_t>> mapped_;
};

constexpr const char* kUrls[] = {
    "v4l2:///nosuch/video0",
    "v4l2:///nosuch/video0?depth=/nosuch/video1",
    "v4l2://?depth=/nosuch/video1",
    "v4l2:///nosuch/video0?format=YUYV&width=64&height=48&control.gain=1&control.exposure_auto=manual",
    "v4l2:///nosuch/video0?format=NV12M&width=64&height=48",
    "v4l2:///nosuch/video0?format=MJPEG&width=64&height=48&rate_hz=30",
    "v4l2:///nosuch/video0?format=GRBG&width=64&height=48",
    "v4l2:///nosuch/video0?format=Y10B&gray_bits=10&depth=/nosuch/video1&depth_format=Z16",
};

void check_frame(const camloc::FrameSourceInfo& info, const camloc::FrameBuffer& frame) {
  require(frame.gray.width == info.color_width && frame.gray.height == info.color_height);
  require(frame.depth.width == info.depth_width && frame.depth.height == info.depth_height);
  require(frame.gray.pixels.size() == static_cast<std::size_t>(frame.gray.width) * static_cast<std::size_t>(frame.gray.height));
  require(frame.color.pixels.empty() || frame.color.pixels.size() == frame.gray.pixels.size());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 1) return 0;
  const auto driver = std::make_shared<HostileDriver>(data + 1, size - 1);
  const camloc::Result<camloc::SourceUrl> url = camloc::parse_source_url(kUrls[data[0] % std::size(kUrls)]);
  const camloc::SystemFolders nowhere{"/nosuch"};
  auto source = camloc::open_v4l2_source_on(driver, nowhere, *url, {.wants_color = data[0] >= 128});
  if (!source) {
    require(source.status().message().find('\n') == std::string::npos);
    return 0;
  }
  camloc::FrameBuffer frame;
  std::int64_t last_stamp_ns = -1'000'000'000'000;
  for (int i = 0; i < 20; ++i) {
    const camloc::Status status = (*source)->next(&frame, std::chrono::milliseconds(10));
    require(status.message().find('\n') == std::string::npos);
    if (status.code() == camloc::ErrorCode::kUnavailable && !(*source)->restart()) break;
    if (!status) continue;
    check_frame((*source)->info(), frame);
    require(frame.stamp_ns > last_stamp_ns);
    last_stamp_ns = frame.stamp_ns;
  }
  return 0;
}
