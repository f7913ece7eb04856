// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Every number that comes back from the driver is compared with what was mapped before a byte is read.
#include "drivers/v4l2/v4l2_stream.h"

#include <linux/videodev2.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <utility>

namespace camloc {

namespace {

constexpr std::uint32_t kNumBuffers = 4;
constexpr std::uint32_t kMinBuffers = 2;  // one to look at, one for the driver to fill
constexpr std::uint32_t kMaxBuffers = 8;
constexpr std::int64_t kNsPerSecond = 1'000'000'000;
constexpr std::int64_t kMaxStampAgeNs = 5 * kNsPerSecond;
constexpr std::int64_t kMaxStampAheadNs = 1'000'000;
constexpr std::uint32_t kMaxGap = 100'000;  // a greater one is a count that started again, or none at all

/// A v4l2_buffer and the planes that it points to in the multi-planar API.
struct BufferRequest {
  v4l2_buffer buffer{};
  v4l2_plane planes[VIDEO_MAX_PLANES]{};

  BufferRequest(const V4l2Device& device, unsigned index) {
    buffer.index = index;
    buffer.type = device.buffer_type();
    buffer.memory = V4L2_MEMORY_MMAP;
    if (!device.is_multiplanar()) return;
    buffer.m.planes = planes;
    buffer.length = VIDEO_MAX_PLANES;
  }
  BufferRequest(const BufferRequest&) = delete;
  BufferRequest& operator=(const BufferRequest&) = delete;
  // The answer may have moved the pointer; only our own planes are looked at.
  void restore_planes(const V4l2Device& device) {
    if (device.is_multiplanar()) buffer.m.planes = planes;
  }
};

V4l2StampSource declared_source(std::uint32_t flags) {
  if ((flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) != V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC) return V4l2StampSource::kArrival;
  const bool is_start = (flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
  return is_start ? V4l2StampSource::kStartOfExposure : V4l2StampSource::kEndOfFrame;
}

/// Nanoseconds of a stamp that can be true: not in the future, not old.
std::optional<std::int64_t> believable_ns(const timeval& stamp, std::int64_t now_ns) {
  if (stamp.tv_sec < 0 || stamp.tv_sec > now_ns / kNsPerSecond + 1 || stamp.tv_usec < 0 || stamp.tv_usec >= 1'000'000) return std::nullopt;
  const std::int64_t ns = stamp.tv_sec * kNsPerSecond + stamp.tv_usec * 1000;
  if (ns <= 0 || ns > now_ns + kMaxStampAheadNs || ns < now_ns - kMaxStampAgeNs) return std::nullopt;
  return ns;
}

}  // namespace

V4l2Stream::~V4l2Stream() {
  stop();
  unmap_buffers();
}

Result<std::unique_ptr<V4l2Stream>> V4l2Stream::open(V4l2Device device, const V4l2Agreement& agreement) {
  std::unique_ptr<V4l2Stream> stream(new V4l2Stream(std::move(device), agreement));
  if (Status status = stream->map_buffers(); !status) return status;
  return stream;
}

Status V4l2Stream::map_buffers() {
  v4l2_requestbuffers request{};
  request.count = kNumBuffers;
  request.type = device_.buffer_type();
  request.memory = V4L2_MEMORY_MMAP;
  if (const int error = device_.ioctl(VIDIOC_REQBUFS, &request); error != 0) {
    if (error == -EBUSY) return {ErrorCode::kUnavailable, device_.path() + ": in use by another program"};
    if (error == -EINVAL) return {ErrorCode::kUnsupported, device_.path() + ": the driver does not share its buffers (mmap)"};
    return {ErrorCode::kUnavailable, device_.path() + ": no buffers (" + errno_text(error) + ")"};
  }
  if (request.count < kMinBuffers) return {ErrorCode::kUnavailable, device_.path() + ": the driver gives less than two buffers"};
  buffers_.resize(std::min(request.count, kMaxBuffers));
  for (unsigned i = 0; i < buffers_.size(); ++i) {
    if (Status status = map_buffer(i, &buffers_[i]); !status) return status;
  }
  return Status::ok();
}

Status V4l2Stream::map_buffer(unsigned index, Buffer* buffer) {
  BufferRequest request(device_, index);
  if (const int error = device_.ioctl(VIDIOC_QUERYBUF, &request.buffer); error != 0) {
    return {ErrorCode::kUnavailable, device_.path() + ": no buffer " + std::to_string(index) + " (" + errno_text(error) + ")"};
  }
  stamp_source_ = declared_source(request.buffer.flags);
  for (unsigned plane = 0; plane < agreed_.layout.format->num_planes; ++plane) {
    const std::size_t length = device_.is_multiplanar() ? request.planes[plane].length : request.buffer.length;
    const std::uint32_t offset = device_.is_multiplanar() ? request.planes[plane].m.mem_offset : request.buffer.m.offset;
    const std::size_t needed = agreed_.layout.plane_bytes(plane);
    if (length < std::max<std::size_t>(needed, 1) || length > kMaxV4l2BufferBytes) {
      return {ErrorCode::kCorrupt, device_.path() + ": the driver (" + device_.driver() + ") contradicts itself: a buffer of " +
                                       std::to_string(length) + " bytes for frames of " + std::to_string(needed)};
    }
    const std::uint8_t* bytes = device_.io().map(device_.fd(), length, offset);
    if (bytes == nullptr) return {ErrorCode::kUnavailable, device_.path() + ": buffer " + std::to_string(index) + " cannot be mapped"};
    buffer->planes[plane] = {bytes, length};
  }
  return Status::ok();
}

void V4l2Stream::unmap_buffers() {
  for (const Buffer& buffer : buffers_) {
    for (const std::span<const std::uint8_t> plane : buffer.planes) {
      if (plane.data() != nullptr) device_.io().unmap(plane.data(), plane.size());
    }
  }
  buffers_.clear();
}

Status V4l2Stream::start() {
  error_ = 0;
  last_sequence_.reset();  // drivers count from zero again
  for (unsigned i = 0; i < buffers_.size() && error_ == 0; ++i) error_ = queue(i);
  auto type = static_cast<int>(device_.buffer_type());
  if (error_ == 0) error_ = device_.ioctl(VIDIOC_STREAMON, &type);
  return error_ == 0 ? Status::ok() : gone();
}

void V4l2Stream::stop() {
  auto type = static_cast<int>(device_.buffer_type());
  [[maybe_unused]] const int ignored = device_.ioctl(VIDIOC_STREAMOFF, &type);  // gone or not, the buffers are ours now
  for (Buffer& buffer : buffers_) buffer.is_queued = false;
}

int V4l2Stream::queue(unsigned index) {
  BufferRequest request(device_, index);
  if (device_.is_multiplanar()) request.buffer.length = agreed_.layout.format->num_planes;
  const int error = device_.ioctl(VIDIOC_QBUF, &request.buffer);
  buffers_[index].is_queued = error == 0;
  return error;
}

Result<bool> V4l2Stream::take(V4l2Frame* frame) {
  if (error_ != 0) return gone();
  BufferRequest request(device_, 0);
  const int error = device_.ioctl(VIDIOC_DQBUF, &request.buffer);
  request.restore_planes(device_);
  if (error == -EAGAIN) return false;
  const unsigned index = request.buffer.index;
  const bool is_ours = error == 0 && index < buffers_.size() && buffers_[index].is_queued;
  if (!is_ours) {
    error_ = error != 0 ? error : -EPROTO;  // a buffer that the driver does not have
    return gone();
  }
  buffers_[index].is_queued = false;
  frame->index = index;
  frame->planes = buffers_[index].planes;
  count_exposure(request.buffer.sequence);
  frame->exposure = exposure_;
  if (Status status = read_planes(request.buffer, &frame->planes); !status) {
    ++num_damaged_;
    give_back(*frame);
    return status;
  }
  frame->stamp_ns = stamp(request.buffer);
  return true;
}

void V4l2Stream::give_back(const V4l2Frame& frame) {
  if (const int error = queue(frame.index); error != 0 && error_ == 0) error_ = error;
}

Status V4l2Stream::gone() const {
  if (error_ == -EPROTO)
    return {ErrorCode::kUnavailable, device_.path() + ": the driver (" + device_.driver() + ") hands out buffers that it does not have"};
  return {ErrorCode::kUnavailable, device_.path() + ": the camera is gone (" + errno_text(error_) + ")"};
}

// Narrows `planes` to the bytes of this frame; kCorrupt where some are missing or more are claimed than there is room for.
Status V4l2Stream::read_planes(const v4l2_buffer& buffer, V4l2Planes* planes) const {
  if ((buffer.flags & V4L2_BUF_FLAG_ERROR) != 0) return {ErrorCode::kCorrupt, device_.path() + ": the driver marked a frame as broken"};
  for (unsigned plane = 0; plane < agreed_.layout.format->num_planes; ++plane) {
    std::span<const std::uint8_t>& bytes = (*planes)[plane];
    const std::size_t end = device_.is_multiplanar() ? buffer.m.planes[plane].bytesused : buffer.bytesused;
    const std::size_t begin = device_.is_multiplanar() ? buffer.m.planes[plane].data_offset : 0;
    const std::size_t size = end - std::min(begin, end);
    const std::size_t needed = std::max<std::size_t>(agreed_.layout.plane_bytes(plane), 1);
    if (end > bytes.size() || size < needed) {
      return {ErrorCode::kCorrupt,
              device_.path() + ": a frame of " + std::to_string(size) + " bytes where there should be " + std::to_string(needed)};
    }
    bytes = bytes.subspan(begin, size);
  }
  return Status::ok();
}

// Reading out and sending a frame takes most of the time between two, so a stamp of its end is put one interval earlier. What is
// left of the error is less than an interval, and the same for every frame.
std::int64_t V4l2Stream::stamp(const v4l2_buffer& buffer) {
  const std::int64_t now_ns = device_.io().monotonic_ns();
  const std::int64_t interval_ns = agreed_.rate_hz > 0 ? std::llround(1e9 / agreed_.rate_hz) : 0;
  stamp_source_ = declared_source(buffer.flags);
  std::optional<std::int64_t> stamp_ns;
  if (stamp_source_ != V4l2StampSource::kArrival) stamp_ns = believable_ns(buffer.timestamp, now_ns);
  if (!stamp_ns) stamp_source_ = V4l2StampSource::kArrival;
  std::int64_t capture_ns = stamp_ns.value_or(now_ns) - (stamp_source_ == V4l2StampSource::kStartOfExposure ? 0 : interval_ns);
  if (capture_ns <= last_stamp_ns_) capture_ns = last_stamp_ns_ + 1;
  last_stamp_ns_ = capture_ns;
  return capture_ns;
}

void V4l2Stream::count_exposure(std::uint32_t sequence) {
  const std::uint32_t gap = last_sequence_ ? sequence - *last_sequence_ - 1 : 0;
  last_sequence_ = sequence;
  ++exposure_;
  if (gap > kMaxGap) return;
  num_lost_ += gap;
  exposure_ += gap;
}

}  // namespace camloc
